"""What the pages of the papers share: the page itself, tables of studies, how long runs took, and the command line."""
