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
	scene = row[column["case"]]; method = row[column["method"]]; error = row[column["error"]];
	word = row[column["word"]]
	cases[scene] = 1
	seen[scene, method] = 1
	words[scene, method] = words[scene, method] " " word ";"
	grade = error + 0 < 1e-3 ? "ok" : error + 0 < 0.1 ? "poor" : "wrong"
	if (error == "failed" ? word !~ /^(diverged|gave up|refused|linear only|as exact)$/ : \
	    !is_number(error) || word != grade) {
		print scene ", " method ": error " error ", word " word
		bad = 1
	}
	if (method == "exact" && word != "refused") {
		limit = scene == "grazing contact" ? 1e-7 : scene ~ /^stiff/ ? 1e-8 : 1e-9
		if (error + 0 > limit || error == "failed") {
			print scene ", exact: found " error ", expected 0, tolerance " limit
			bad = 1
		}
	}
}
function known(scene, method, pattern) {
	if (words[scene, method] !~ pattern) {
		print scene ", " method ": found" words[scene, method] " expected " pattern;
		bad = 1 }
}
END {
	for (scene in cases) {
		count++
		for (method in wanted)
			if (!((scene, method) in seen)) { print scene ": no " method; bad = 1 }
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
