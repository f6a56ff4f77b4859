"""What the node of a monitor needs on any transport; nothing here knows one."""
