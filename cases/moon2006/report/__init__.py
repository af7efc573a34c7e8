"""The page of Moon, Kevrekidis & Sundaresan (2006): every figure that was run, beside what the paper says of it. `scripts/report moon2006` builds it."""
