# SPDX-License-Identifier: GPL-3.0-or-later
# of: less.csv
# Of each scene the fewest multiplications of what is no farther off than the
# model is anyway, of those of the whole.
NR == 1 { read_head($0, column); next }
{
	split("", row)
	split_row($0, row)
	scene = row[column["scene"]]; cost = row[column["multiplications"]] + 0; model = row[column["model"]]
	if (!(scene in most)) scenes[++count] = scene
	# of the beam the mesh that the line is of
	whole = model ~ /^elements/ ? row[column["kept"]] == 5 : scene != "beam" && model == "modes"
	if (whole && cost > most[scene]) most[scene] = cost
	else most[scene] += 0
	if (model !~ /^elements/ && row[column["error_over_peak"]] + 0 <= row[column["error_anyway"]] + 0 &&
	    (!(scene in least) || cost < least[scene])) least[scene] = cost
}
END {
	for (i = 1; i <= count; i++)
		text = text (i > 1 ? ", " : "") scenes[i] " " least[scenes[i]] " of " most[scenes[i]]
	print "A few modes are as good as the model itself: " text " multiplications"
}
