# SPDX-License-Identifier: GPL-3.0-or-later
# modes.awk: what a report says of modes.spec against frequencies and damping ratios as the spec has them. -v what=text,
# the table of --explain and of the banner; what=poles and what=modes, those lists of --explain=json; what=polynomial,
# B(s). Numbers of texts are rounded to 8 digits, those of B(s) to 12.

function bad(text) {
	print text
	wrong = 1
}

function near(name, is, should, tolerance, size) {
	size = should < 0 ? -should : should
	if (!(is - should <= tolerance * size && should - is <= tolerance * size))
		bad(sprintf("%s is %.17g, expected %.17g within %g of it", name, is, should, tolerance))
}

# the poles of s^2 + 2 zeta w s + w^2, and what they multiply B(s) with
function mode(hertz, ratio, fold, w) {
	w = 2 * pi * hertz
	known++
	f[known] = hertz
	zeta[known] = ratio
	many[known] = fold
	re[known] = -ratio * w
	im[known] = ratio * ratio < 1 ? w * sqrt(1 - ratio * ratio) : 0
	for (; fold > 0; fold--) {
		if (im[known] > 0)
			times(w * w, 2 * ratio * w, 1)
		else
			times(-re[known], 1, 0)
	}
}

# B (c + b s + a s^2), the highest first
function times(c, b, a, k) {
	for (k = degree + 2; k >= 0; k--)
		B[k] = c * B[k] + (k > 0 ? b * B[k - 1] : 0) + (k > 1 ? a * B[k - 2] : 0)
	degree += a ? 2 : 1
}

# the next one of the list, in its order
function compare(x, y, hertz, ratio, fold, tolerance) {
	row++
	near("real part " row, x, re[row], tolerance)
	near("imaginary part " row, y, im[row], tolerance)
	near("frequency " row, hertz, f[row], tolerance)
	near("damping ratio " row, ratio, zeta[row], tolerance)
	near("multiplicity " row, fold, many[row], 0)
}

BEGIN {
	pi = atan2(0, -1)
	B[0] = 1
	mode(0, 0, 2)
	mode(0.5, -0.05, 1)
	mode(10 / (2 * pi), 1, 1)
	mode(3, 0.1, 1)
	mode(20 / (2 * pi), -1, 1)
	mode(7, 0, 2)
	for (k = 1; k <= known; k++)
		for (i = f[k] > 0 ? 1 : 2; i <= many[k]; i++)
			of[++modes] = k
}

what == "text" && inside && /[0-9]/ {
	sub(/^ \*/, "")
	fold = sub(/\(2-fold\)/, "") ? 2 : 1
	if ($2 == "+-")
		compare($1, $3, $5, $6, fold, 6e-8)
	else
		compare($1, 0, $2, $3, fold, 6e-8)
	next
}
what == "text" { inside = /pole \[1\/s\] +frequency \[Hz\] +damping ratio/ }

# those of shapes and zeros stand elsewhere
/^  "/ { poles = /^  "poles":/ }
what == "poles" && poles && /"re":/ {
	gsub(/[^-+.0-9e ]|re|multiplicity/, "")
	row += !($2 < 0)
	near("real part " row, $1, re[row], 1e-14)
	near("imaginary part " row, $2 < 0 ? -$2 : $2, im[row], 1e-14)
	near("multiplicity " row, $3, many[row], 0)
	minus += $2 < 0
}

what == "modes" && /"frequency_hz":/ {
	gsub(/"[a-z_]*":|[^-+.0-9e ]/, "")
	k = of[++row]
	near("frequency " row, $1, f[k], 1e-14)
	near("damping ratio " row, $2, zeta[k], 1e-14)
}

what == "polynomial" {                      # further lines begin with a sign
	inside = sub(/.*B\(s\) = /, "") || inside && /^( \*)? +[-+] /
	sub(/^ \*/, "")
	for (i = 1; i <= NF && inside; i++) {
		if ($i == "+" || $i == "-")
			continue
		sign = $(i - 1) == "-" && i > 1 ? -1 : 1
		factor = $i ~ /^s/ ? 1 : $(i++)
		power = $i ~ /\^/ ? substr($i, 3) : $i == "s" ? 1 : 0
		near("factor of s^" power, sign * factor, B[power], 6e-12)
		row++
	}
}

END {
	rows["text"] = rows["poles"] = known
	rows["modes"] = modes
	rows["polynomial"] = degree - 1         # two poles at 0
	if (row != rows[what])
		bad(sprintf("%d rows, expected %d", row, rows[what]))
	if (what == "poles" && minus != 3)
		bad(sprintf("%d poles below the real axis, expected 3", minus))
	exit wrong
}
