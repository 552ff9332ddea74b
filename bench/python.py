# SPDX-License-Identifier: GPL-3.0-or-later
# ns per step of a million steps by the package, the least of 10 samples: into an array of the caller's, into a new one,
# by NAME_run
import sys
import time

import numpy as np

from plgen import Model

STEPS = 1000000
m = Model(sys.argv[1])
u = np.zeros((STEPS, 1)) if m.inputs else STEPS
rows = np.zeros((STEPS + 1, len(m.outputs)))
least = [1e300, 1e300, 1e300]
for i in range(30):
    m.reset()
    start = time.perf_counter()
    m.run(u, out=None if i % 3 == 1 else rows, blocks=i % 3 == 2)
    least[i % 3] = min(least[i % 3], (time.perf_counter() - start) * 1e9 / STEPS)
print('%.2f %.2f %.2f' % tuple(least))
