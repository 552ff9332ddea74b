# SPDX-License-Identifier: GPL-3.0-or-later
# A linear model with a need, drawn from a seed: 1 to 6 masses in a chain with further springs, on the ground or free,
# damping of every kind (none, proportional, dashpots anywhere, strong), loads, starts. -v seed=N
function uniform(a, b) { return a + (b - a) * rand() }
function log_uniform(a, b) { return exp(uniform(log(a), log(b))) }
function number(x) { return sprintf("%.4g", x) }
BEGIN {
	srand(seed)
	for (i = 0; i < 20; i++)
		rand()
	n = 1 + int(6 * rand())
	free = n > 1 && rand() < 0.15   # it may move as a whole
	kind = int(5 * rand())          # of damping
	step = log_uniform(0.002, 0.1)
	stiff = log_uniform(5, 500)
	print "model drawn"
	line = "coord x1"
	for (i = 2; i <= n; i++)
		line = line ", x" i
	print line
	line = "init x1 = " number(uniform(-1, 1))
	for (i = 2; i <= n; i++)
		if (rand() < 0.5)
			line = line ", x" i (rand() < 0.5 ? "'" : "") " = " number(uniform(-1, 1))
	print line
	for (i = 1; i <= n; i++)
		print "mass " number(log_uniform(0.3, 3)) " at x" i
	for (i = 1; i <= n; i++) {
		k = stiff * log_uniform(0.3, 3)
		to = i == 1 ? "ground" : "x" (i - 1)
		if (i == 1 && free)
			continue
		print "spring " number(k) " between x" i ", " to
		c = kind == 1 ? 0.004 * k : kind == 2 ? log_uniform(0.01, 2) : kind == 3 ? log_uniform(1, 60) : 0
		if (kind == 4 && i == n)
			c = 0.5
		if (c)
			print "damper " number(c) " between x" i ", " to
	}
	if (n > 2 && rand() < 0.5)
		print "spring " number(stiff * log_uniform(0.1, 1)) " between x1, x" n
	loads = int(3 * rand())
	for (l = 0; l < loads; l++) {
		w = log_uniform(0.5, 40)
		wave = rand() < 0.5 ? "cos" : "sin"
		grow = rand() < 0.3 ? "*exp(-" number(uniform(0.1, 1)) "*t)" : rand() < 0.2 ? "*t" : ""
		print "force " number(uniform(-5, 5)) "*" wave "(" number(w) "*t + " number(uniform(0, 6)) ")" grow \
		      " on x" (1 + int(n * rand()))
	}
	if (rand() < 0.3)
		print "force " number(uniform(-5, 5)) " on x" (1 + int(n * rand()))
	line = "output y = " number(uniform(0.2, 2)) "*x" (1 + int(n * rand()))
	if (rand() < 0.5)
		line = line " - " number(uniform(0.2, 2)) "*x" (1 + int(n * rand())) "'"
	print line
	print "step " number(step)
	print "need y within 1e-" (1 + seed % 12) (rand() < 0.3 ? " %" : "") " until " \
	      number(step * log_uniform(30, 3000))
}
