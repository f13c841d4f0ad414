"""Slow cases of rare faults run in the long tests only, which set PCOR_EVERY_CASE."""

import os
import unittest

in_long_tests = unittest.skipUnless(os.environ.get("PCOR_EVERY_CASE"), "runs in the long tests")
