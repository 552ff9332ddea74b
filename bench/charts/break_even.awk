# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f csv.awk -f break_even.awk generation.csv precision.csv: after how many steps generating pays.
# break_even.csv: on each model, against each rival, from precision.csv: its cheapest setting whose largest
# error is at most 1e-6, in float 1e-3 (ns per unit of output, median), ours in the same type likewise, and after how
# many steps of ours the time to generate and compile is won back:
#     steps = (generate + compile - 2 empty) / (rival's ns per step of ours - ours)
# ours by a tolerance have a step a unit. A model that generation.csv has not is left out.
# never: the rival is faster or, within the 10 % that times hold, as fast, or only the rival comes to that error; none:
# no setting of the rival comes to it, or none that was timed (dear), so there is nothing to win back against.
# The cheapest of them so far
function offer(key) {
	if (!(key in cheapest) || ns < cheapest[key]) { cheapest[key] = ns; setting[key] = tried[k];
		step[key] = row[column["setting_kind"]] == "tolerance" ? row[column["unit_s"]] : setting[key];
		error_at[key] = error; method_at[key] = method }
}
BEGIN { target["double"] = "1e-6"; target["float"] = "1e-3" }
FNR == 1 { file++ }
FNR == 1 { split("", column); read_head($0, column); next }
file == 1 {
	split_row($0, row)
	once[row[1]] = row[column["generate_ms_median"]] + row[column["compile_ms_median"]] - 2 * \
		row[column["empty_ms_median"]]
	next
}
{
	split("", row)
	split_row($0, row)
	model = row[column["model"]]; method = row[column["method"]]; family = row[column["family"]]
	real = method ~ /float/ ? "float" : "double"
	unit[model] = row[column["unit_s"]]
	if (!(model in known)) { known[model] = 1; models[++model_count] = model }
	if (family != "ours" && !((model, method) in rival_seen)) {
		rival_seen[model, method] = 1
		rivals[model, ++rival_count[model]] = method
		real_of[method] = real
	}
	tries = split(row[column["setting"]], tried, " ")
	split(row[column["largest"]], largest, " "); split(row[column["ns_median"]], median, " ")
	for (k = 1; k <= tries; k++) {
		error = largest[k]; ns = median[k] + 0
		if (!is_number(error) || error + 0 > target[real] + 0) continue
		if (median[k] == "dear") dear[model SUBSEP "rival" SUBSEP method] = 1
		if (ns <= 0) continue
		offer(family == "ours" ? model SUBSEP "ours" SUBSEP real : model SUBSEP "rival" SUBSEP method)
	}
}
END {
	print "model,real,target,rival,rival_setting,rival_error,rival_ns_per_unit,ours,our_step_s,our_error," \
		"our_ns_per_unit,generate_and_compile_ms,break_even_units,break_even_steps,word"
	for (m = 1; m <= model_count; m++) {
		model = models[m]
		if (!(model in once)) continue
		for (r = 1; r <= rival_count[model]; r++) {
			method = rivals[model, r]; real = real_of[method]
			rival = model SUBSEP "rival" SUBSEP method; ours = model SUBSEP "ours" SUBSEP real
			printf "%s,%s,%s,\"%s\",", model, real, target[real], method
			if (rival in cheapest) printf "%s,%s,%.6g,", setting[rival], error_at[rival], cheapest[rival]
			else printf rival in dear ? "dear,dear,dear," : "failed,failed,failed,"
			if (ours in cheapest)
				printf "\"%s\",%s,%s,%.6g,", method_at[ours], step[ours], error_at[ours],
				cheapest[ours]
			else printf "none,failed,failed,failed,"
			printf "%.6g,", once[model]
			if (!(rival in cheapest)) print rival in dear ? "none,none,dear" : "none,none,not reached"
			else if (!(ours in cheapest)) print "never,never,ours not reached"
			else if (cheapest[rival] < cheapest[ours] / 1.1) print "never,never,rival is faster"
			else if (cheapest[rival] <= cheapest[ours] * 1.1) print "never,never,as fast"
			else {
				units = 1e6 * once[model] / (cheapest[rival] - cheapest[ours])
				printf "%.6g,%.6g,\n", units, units * unit[model] / step[ours]
			}
		}
	}
}
