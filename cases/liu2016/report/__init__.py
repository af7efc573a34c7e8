"""The page of Liu, van Wachem, Mudde, Chen & van Ommen (2016): every figure that was run, beside what the paper says of it. `scripts/report liu2016` builds it."""
