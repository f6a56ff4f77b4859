"""The view as a page on this machine: HTML that works by itself, and events that keep it new."""
