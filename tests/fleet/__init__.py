"""Two real robots: the guarantee of one rests on that of the other."""
