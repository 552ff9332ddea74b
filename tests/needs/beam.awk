# SPDX-License-Identifier: GPL-3.0-or-later
# A cantilever of 15 masses, bending stiffness by differences of four points, proportional damping, its tip driven
BEGIN {
	n = 15
	EI = 40000
	for (i = 1; i <= n + 1; i++)    # curvature at each joint, the clamped one first
		for (j = 0; j < 3; j++) {
			c = j == 1 ? -2 : 1
			for (k = 0; k < 3; k++)
				if (i - 2 + j >= 1 && i - 2 + k >= 1 && i - 2 + j <= n && i - 2 + k <= n && i <= n)
					K[i - 2 + j, i - 2 + k] += EI * c * (k == 1 ? -2 : 1)
		}
	print "model drawn"
	print "coord q[15]"
	printf "matrix K = ["
	for (i = 1; i <= n; i++)
		for (j = 1; j <= n; j++)
			printf("%s%d", (j > 1 ? ", " : (i > 1 ? "; " : "")), K[i, j])
	print "]"
	printf "matrix f = ["
	for (i = 1; i <= n; i++)
		printf("%s%d", (i > 1 ? "; " : ""), i == n)
	print "]"
	print "q'' + 0.001*K*q' + 0.2*q' + K*q = 20*f*cos(3*t)"
	print "output tip = q[15]"
	print "step 0.01"
	print "need tip within 1e-4 until 20"
}
