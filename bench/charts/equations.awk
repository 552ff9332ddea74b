# SPDX-License-Identifier: GPL-3.0-or-later
# awk -v name=NAME -f equations.awk: of C that plgen prints for scheme radau with --rhs, the functions of equations.sh.
# Of NUMBER, and its constants
function put(line,    text) {
	gsub(/double/, "NUMBER", line)
	while (match(line, /[0-9]+\.[0-9]+(e[-+]?[0-9]+)?/)) {
		text = text substr(line, 1, RSTART - 1) "EXACTLY(" substr(line, RSTART, RLENGTH) ")"
		line = substr(line, RSTART + RLENGTH)
	}
	return text line "\n"
}
/_entry\[[0-9]+\]\[3\] = / { listed = 1; next }
listed && /^\};/ { listed = 0; next }
listed { entries = entries $0 }
$0 ~ "^[a-z ]*void " name "_[a-z]*\\(" { part = $0; sub(/\(.*/, "", part); sub(/.*_/, "", part); open = 0 }
/^\{/ { open = 1; next }
/^\}/ { open = 0; part = "" }
/;$/ && !open { part = "" }
open && part == "rhs" { slopes = slopes put($0) }
open && part == "linearize" && !/\(void\)/ { known = known put($0) }
open && part == "known" && /double load[0-9]/ {
	sub(/;  \/\* /, " = {"); sub(/ \*\//, "};")
	loads = loads put($0)
}
open && part == "known" && /node\[/ { loads = loads put($0) }
/^enum \{.*_STATES = / { states = $0; sub(/.*_STATES = /, "", states); n = (states + 0) / 2 }
END {
	if (!n || slopes == "" || known == "" || entries == "") {
		print "equations.awk: " name ": not all is there that plgen printed" > "/dev/stderr"
		exit 1
	}
	printf "enum { %s_coordinates = %d };\n", name, n
	printf "INLINE void %s_slopes(NUMBER t, const NUMBER *y, NUMBER *dydt)\n{\n%s}\n", name, slopes
	count = split(entries, entry, /\}/) - 1
	printf "INLINE void %s_jacobian(NUMBER t, const NUMBER *y, NUMBER *Jq, NUMBER *Jv)\n{\n", name
	printf "    NUMBER left[%d], slope[%d], node[4];\n    {\n%s    }\n%s", n, count, loads, known
	print "    (void)t, (void)y, (void)left, (void)node;"
	for (i = 0; i < n * n; i++) value["Jq", i] = value["Jv", i] = "0"
	for (i = 1; i <= count; i++) {
		gsub(/[{, ]+/, " ", entry[i])
		split(entry[i], at, " ")
		value[at[3] == 1 ? "Jq" : "Jv", at[1] * n + at[2]] = "slope[" i - 1 "]"
		by_velocity += at[3] == 0
	}
	for (i = 0; i < n * n; i++)
		printf "    Jq[%d] = %s; Jv[%d] = %s;\n", i, value["Jq", i], i, value["Jv", i]
	printf "}\n#define OF_%s(X) X(%s, %d)\n#define ALONE_%s(X) %s\n", name, name, n, name,
		by_velocity ? "" : "X(" name ", " n ")"
}
