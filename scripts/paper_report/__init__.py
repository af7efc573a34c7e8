"""Code that the pages of the papers share: the page itself, tables of studies, run times, and the command line."""
