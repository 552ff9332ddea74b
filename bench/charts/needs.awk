# SPDX-License-Identifier: GPL-3.0-or-later
# awk -v scene=NAME -f needs.awk: alternatives of plgen --explain=json, one a line there, as CSV. What there is not, or
# is not known, is left out.
# The value of a key, without quotes; '' where there is none. Of errors: the first.
function value(key,    at, rest) {
	at = index($0, "\"" key "\": ")
	if (!at) return ""
	rest = substr($0, at + length(key) + 4)
	if (substr(rest, 1, 1) == "\"") {
		rest = substr(rest, 2)
		return substr(rest, 1, index(rest, "\"") - 1)
	}
	match(rest, /^[^,}]*/)
	return substr(rest, 1, RLENGTH)
}
/^    \{.*"taken": / && /"cost": / {
	modes = value("modes")
	gsub(/, */, " ", modes)
	measured = index($0, "\"measured\": ") > 0
	printf "%s,%s,%s,%s,%s,%s,%s,%s,%s,%s,%s,%s,%s,%s\n", scene, measured ? "second" : "step", value("real"),
		value("accuracy"), measured ? "" : value("form"), modes, value("statics"), value("scheme"),
		value("step"), value("tolerance"), value("cost"), value("excess"), value("neighbours"), value("taken")
}
