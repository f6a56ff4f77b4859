"""Pages for a person on this machine: served on the loopback interface, with limits."""
