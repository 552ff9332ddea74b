# SPDX-License-Identifier: GPL-3.0-or-later
# awk -v list=methods.list -v special=special.list -f csv.awk -f methods.awk precision_raw.csv: every model of a quick
# run has every method of the list (propagators and structural ones only where it is linear), those of special.list by
# model, and of ours those that there are for it; each row has numbers, or a word and the flag `failed`.
function ours_of(model) {
	if (model == "scs")
		return "exact;exact, direct;exact, delta;exact, kick-drift-kick;exact, compensated;exact, float;" \
		"exact, float, delta;exact, float, kick-drift-kick;exact, float, compensated;pl"
	if (model == "gear1") return "exact;etd1;etdrk2;etdrk4;nc2;nc3;dq4;bm3"
	return "pl;etd1;etdrk2;etdrk4;nc2;nc3;dq4;bm3" (model == "pendulum" ? ";taylor;taylor 8;radau;auto" : "")
}
BEGIN {
	while ((getline line < list) > 0) {
		family = line; sub(/ .*/, "", family)
		sub(/^[a-z]* /, "", line)
		family_of[line] = family
	}
	while ((getline line < special) > 0) specials[++special_count] = line
	split("q_end q_between v_end v_between largest", errors, " ")
}
NR == 1 { read_head($0, column); next }
{
	split("", row)
	split_row($0, row)
	model = row[column["model"]]; method = row[column["method"]]
	seen[model, method] = 1
	for (e = 1; e <= 5; e++) {
		value = row[column[errors[e]]]
		good = row[column["failed"]] == 0 ? is_number(value) &&
			value >= 0 : value ~ /^(failed|refused|cannot|diverged|nan)$/
		if (!good) { print model ", " method ": " errors[e] " is " value ", failed " row[column["failed"]];
			bad = 1 }
	}
	if (row[column["ns_median"]] == "dear" && (row[column["failed"]] != 0 ||
	    row[column["family"]] != "adaptive")) { print model ", " method ": left without a time"; bad = 1 }
	timed = row[column["ns_units"]] * row[column["unit_s"]]
	if (is_number(row[column["ns_median"]]) && timed != row[column["history_s"]]) {
		print model ", " method ": timed over " row[column["ns_units"]] " units of " \
			row[column["unit_s"]] " s, expected " \
			row[column["history_s"]] " s, the whole history"
		bad = 1
	}
	apart = row[column["truth_agreement"]]
	if (row[column["failed"]] == 0 && apart + 0 > 1e-11) {
		print model ": two roads to what is true are " apart " apart, tolerance 1e-11"
		bad = 1
	}
}
END {
	for (k = 1; k <= special_count; k++) {
		model = method = specials[k]
		sub(/ .*/, "", model)
		sub(/^[^ ]* /, "", method)
		if (!((model, method) in seen)) { print model ": no " method; bad = 1 }
	}
	models = split("pendulum beam4 gear1 scs", model_list, " ")
	for (m = 1; m <= models; m++) {
		model = model_list[m]
		for (method in family_of)
			if ((family_of[method] !~ /^(propagator|structural)$/ || model == "scs") &&
			    !((model, method) in seen)) {
				print model ": no " method
				bad = 1
			}
		n = split(ours_of(model), ours, ";")
		for (k = 1; k <= n; k++)
			if (!((model, ours[k]) in seen)) { print model ": no " ours[k]; bad = 1 }
	}
	exit bad
}
