# SPDX-License-Identifier: GPL-3.0-or-later
# awk -v list=methods.list -f csv.awk -f hard.awk hard.csv: every method of the list, naive residues and ours on each of
# the 12 cases; a cell without a number has its word, one with a number the word that goes with it; known failures are
# told as such, and exact has none.
BEGIN {
	while ((getline line < list) > 0) {
		sub(/^[a-z]* /, "", line)
		wanted[line] = 1
	}
	wanted["naive residues"] = wanted["exact"] = wanted["exact, compensated"] = wanted["exact, float"] = \
		wanted["pl"] = 1
	wanted["etd1"] = wanted["etdrk2"] = wanted["etdrk4"] = wanted["bm3"] = 1
}
NR == 1 { read_head($0, column); next }
{
	split("", row)
	split_row($0, row)
	of = row[column["case"]]; method = row[column["method"]]; error = row[column["error"]];
	word = row[column["word"]]
	cases[of] = 1
	seen[of, method] = 1
	words[of, method] = words[of, method] " " word ";"
	grade = error + 0 < 1e-3 ? "ok" : error + 0 < 0.1 ? "poor" : "wrong"
	if (error == "failed" ? word !~ /^(diverged|gave up|refused|linear only|as exact)$/ : \
	    !is_number(error) || word != grade) {
		print of ", " method ": error " error ", word " word
		bad = 1
	}
	if (method == "exact" && word != "refused") {
		limit = of == "grazing contact" ? 1e-7 : of ~ /^stiff/ ? 1e-8 : 1e-9
		if (error + 0 > limit || error == "failed") {
			print of ", exact: found " error ", expected 0, tolerance " limit
			bad = 1
		}
	}
}
function known(of, method, pattern) {
	if (words[of, method] !~ pattern) { print of ", " method ": found" words[of, method] " expected " pattern;
		bad = 1 }
}
END {
	for (of in cases) {
		count++
		for (method in wanted)
			if (!((of, method) in seen)) { print of ": no " method; bad = 1 }
	}
	if (count != 12) { print count + 0 " cases, expected 12"; bad = 1 }
	known("stiff spring", "explicit Euler", "diverged; diverged")
	known("stiff spring", "RK4", "diverged; diverged")
	known("stiff spring", "central difference", "diverged; diverged")
	known("stiff van der Pol", "RK4", "diverged; diverged")
	known("stiff van der Pol", "exact", "refused; refused")
	known("critical damping", "naive residues", "diverged|wrong|poor")
	known("equal poles", "naive residues", "diverged|wrong|poor")
	known("rigid body", "naive residues", "diverged|wrong|poor")
	known("resonance", "naive residues", "diverged|wrong|poor")
	known("poles -1e8 and -1e-3", "RK4", "diverged")
	known("poles -1e8 and -1e-3", "CVODE Adams", "gave up")
	known("grazing contact", "RK4", "diverged|wrong|poor")
	known("grazing contact", "CVODE BDF", "diverged|wrong|poor")
	exit bad
}
