# SPDX-License-Identifier: GPL-3.0-or-later
# awk [-v where='model=scs;real=float'] -v name=FILE.csv -f csv.awk -f table.awk FILE.csv: its rows as an HTML table;
# more than 60 stay in the file, which is linked. Words for a failure are marked. A column `settings` becomes a list
# below, once a method. What HTML lets a page leave open is left open.
function escaped(text) {
	gsub(/&/, "\\&amp;", text)
	gsub(/</, "\\&lt;", text)
	gsub(/>/, "\\&gt;", text)
	return text
}
function class_of(head, text) {
	if (text ~ /^(failed|diverged|refused|nan|-nan|inf|-inf|wrong|gave up|not reached|ours not reached|no|FAILED)$/)
		return "bad"
	if (text ~ /^(poor|never|dear)$/) return "poor"
	if (text ~ /^(linear only|as exact)$/) return "none"
	return is_number(text) ? "n" : ""
}
function cell(head, text,    class) {
	if (head == "failed") text = text == "1" ? "failed" : text == "0" ? "" : text
	class = class_of(head, text)
	return "<td" (class == "" ? "" : " class=" class) ">" escaped(text)
}
NR == 1 {
	columns = split_row($0, head)
	for (i = 1; i <= columns; i++) {
		column[head[i]] = i
		if (head[i] == "settings") hidden[i] = 1
	}
	conditions = split(where, condition, ";")
	for (i = 1; i <= conditions; i++) {
		split(condition[i], part, "=")
		chosen[column[part[1]]] = part[2]
		hidden[column[part[1]]] = 1
	}
	next
}
{
	split("", row)
	split_row($0, row)
	for (i in chosen) if (row[i] != chosen[i]) next
	line = "<tr>"
	for (i = 1; i <= columns; i++) if (!(i in hidden)) line = line cell(head[i], row[i])
	lines[++count] = line
	if ("settings" in column && row[column["settings"]] != "") {
		setting = (("method" in column) ? row[column["method"]] ": " : "") row[column["settings"]]
		if (!(setting in listed)) { listed[setting] = 1; settings[++setting_count] = setting }
	}
}
END {
	link = "<a href=\"" name "\">" name "</a>"
	gsub(/;/, ", ", where)
	if (count == 0) { print "<p class=bad>" link " has no rows" (where == "" ? "" : " of " escaped(where)) ".</p>";
		exit }
	if (count > 60) { print "<p class=numbers>Numbers: " link ", " count " rows.</p>"; exit }
	print "<p class=numbers>" link (where == "" ? "" : ": " escaped(where)) "</p><div class=wide><table><tr>"
	for (i = 1; i <= columns; i++) if (!(i in hidden)) { title = head[i]; gsub(/_/, "_<wbr>", title);
		printf "<th>%s", title }
	print ""
	for (i = 1; i <= count; i++) print lines[i]
	print "</table></div>"
	if (setting_count) {
		print "<details><summary>Settings</summary><ul class=settings>"
		for (i = 1; i <= setting_count; i++) print "<li>" escaped(settings[i])
		print "</ul></details>"
	}
}
