"""The page of Liu, van Wachem, Mudde, Chen & van Ommen (2016): every figure that was run, compared with the text of the paper. `scripts/report liu2016` builds it."""
