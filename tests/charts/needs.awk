# SPDX-License-Identifier: GPL-3.0-or-later
# awk -f csv.awk -f needs.awk needs.csv: TAP. Of each scene one alternative is taken; it meets the need, and nothing
# that is cheaper does; there are cheaper ones that miss it, and dearer ones.
function result(good, name, said) {
	if (!good) { print "# " said; bad = 1 }
	printf "%s %d - %s\n", good ? "ok" : "not ok", ++count, name
}
NR == 1 { read_head($0, column); next }
{
	split("", row)
	split_row($0, row)
	scene = row[column["scene"]]; neighbours = row[column["neighbours"]]
	measured = row[column["unit"]] == "second"
	n[scene]++
	cost[scene, n[scene]] = row[column["cost"]] + 0
	if (!is_number(row[column["cost"]]) || !is_number(row[column["error_over_need"]]) || row[column["cost"]] <= 0)
		unknown = unknown " " $0
	# what references leave: a hundredth; what was tried from elsewhere has to meet it there too
	below[scene, n[scene]] = row[column["error_over_need"]] + 0 <= (measured ? 0.99 : 1) && \
		(neighbours == "" || neighbours + 0 <= 0.99)
	if (row[column["taken"]] == "true") { takes[scene]++; taken[scene] = n[scene] }
}
function judge(scene, least,    i, t, cheaper, miss, dearer) {
	t = taken[scene]
	result(takes[scene] == 1, scene ": one is taken", takes[scene] + 0 " are")
	result(below[scene, t], scene ": it meets the need", "it does not")
	for (i = 1; i <= n[scene]; i++) {
		if (cost[scene, i] < cost[scene, t] && below[scene, i]) cheaper = cheaper " " cost[scene, i]
		if (cost[scene, i] < cost[scene, t] && !below[scene, i]) miss++
		if (cost[scene, i] > cost[scene, t]) dearer++
	}
	result(cheaper == "", scene ": nothing below the line is cheaper", "at " cost[scene, t] "; cheaper:" cheaper)
	result(n[scene] >= least && dearer > 0, scene ": there was a choice",
	       n[scene] + 0 " alternatives, expected " least)
	if (scene != "quarter_car")
		result(miss > 0, scene ": what is cheaper misses the need", "nothing is cheaper")
}
END {
	result(unknown == "", "numbers in all rows", unknown)
	judge("beam", 40)
	judge("building", 30)
	judge("drivetrain", 15)
	judge("quarter_car", 10)
	judge("pendulum", 20)
	print "1.." count
	exit bad
}
