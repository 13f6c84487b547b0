"""The parts of the page, one file each: what it shows of a session, and which of its methods a control calls."""
