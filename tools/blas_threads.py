"""How many threads numpy's linear algebra may have; numpy reads it when it is first imported."""

BLAS_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""Environment variables that say it."""
