"""The page of Moon, Kevrekidis & Sundaresan (2006): every figure that was run, compared with the text of the paper. `scripts/report moon2006` builds it."""
