"""One folder for each transport: the only parts of the runtime that import its libraries."""
