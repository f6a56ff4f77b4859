"""Several robots: who meets whom, and whose guarantees may fulfil whose demands."""
