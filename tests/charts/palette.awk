# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f palette.awk palette.list: of each pair of colours how far apart they are to eyes without green receptors, and
# of each colour its contrast with both grounds, for those that are too near: nothing where all is well.
# Contrast: WCAG 2.1, (L1 + 0.05)/(L2 + 0.05), at least 3 for graphics. Deuteranopia: the matrix of Viénot, Brettel and
# Mollon (1999) in linear RGB; distance: CIELAB, 1976, at least 10 (a just noticeable difference is 2.3).
function hex(text, i,    digits) {
	digits = "0123456789abcdef"
	return 16 * (index(digits, substr(text, i, 1)) - 1) + index(digits, substr(text, i + 1, 1)) - 1
}
function linear(v) { v /= 255; return v <= 0.04045 ? v / 12.92 : exp(2.4 * log((v + 0.055) / 1.055)) }
function root(t) { return t > 0.008856 ? exp(log(t) / 3) : 7.787 * t + 16 / 116 }
function contrast(a, b) { return a > b ? (a + 0.05) / (b + 0.05) : (b + 0.05) / (a + 0.05) }
# CIELAB of linear RGB into lab[name, 1..3]
function into_lab(name, r, g, b,    x, y, z) {
	x = root((0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.95047)
	y = root(0.2126 * r + 0.7152 * g + 0.0722 * b)
	z = root((0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.08883)
	lab[name, 1] = 116 * y - 16; lab[name, 2] = 500 * (x - y); lab[name, 3] = 200 * (y - z)
}
/^#/ { next }
{
	r = linear(hex($2, 2)); g = linear(hex($2, 4)); b = linear(hex($2, 6))
	light[$1] = 0.2126 * r + 0.7152 * g + 0.0722 * b
	if (NF < 4) next
	name[++names] = $1
	rg = 0.29275 * r + 0.70725 * g
	into_lab($1, rg, rg, b - 0.02234 * r + 0.02234 * g)
	if (split($4, marks, ",") < 6) print $1 ": fewer than 6 marks"
}
END {
	if (names < 5 || !("paper" in light) || !("dark" in light)) print "no palette"
	for (i = 1; i <= names; i++) {
		for (ground = 1; ground <= 2; ground++) {
			where = ground == 1 ? "paper" : "dark"
			c = contrast(light[name[i]], light[where])
			if (c < 3) printf "%s: contrast %.2f with %s, at least 3\n", name[i], c, where
		}
		for (j = 1; j < i; j++) {
			d = 0
			for (k = 1; k <= 3; k++) d += (lab[name[i], k] - lab[name[j], k]) ^ 2
			if (d < 100)
				printf "%s and %s: %.1f apart to a deuteranope, at least 10\n", name[j], name[i],
					sqrt(d)
		}
	}
}
