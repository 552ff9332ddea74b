# SPDX-License-Identifier: GPL-3.0-or-later
# orders.awk: of lines ORDER STEPS ERROR EVENTS SAME the order p, by least squares of log error = log C - p log n + c/n.
# An event ends a piece wherever in its step it falls, and a step with one adds less: by some part of h, which c takes.
{
	row[1] = 1
	row[2] = log($2)
	row[3] = 1/$2
	for (i = 1; i <= 3; i++) {
		for (j = 1; j <= 3; j++)
			a[i, j] += row[i]*row[j]
		a[i, 4] -= row[i]*log($3)
	}
	same += $5 == "yes"
}
END {
	for (i = 1; i <= 3; i++)
		for (j = 1; j <= 3; j++)
			if (j != i) {
				part = a[j, i]/a[i, i]
				for (k = 1; k <= 4; k++)
					a[j, k] -= part*a[i, k]
			}
	order = NR > 7 ? a[2, 4]/a[2, 2] : 0
	good = same == NR && (order - p)^2 < 0.15^2
	printf "%.2f %s\n", order, good ? "yes" : "no"
}
