# SPDX-License-Identifier: GPL-3.0-or-later
# Specs that stand in one file as files of their own: `=== NAME` begins a case, whose lines become NAME.spec, or
# NAME.KIND, those behind a line `---` NAME.REST. The blank lines before the next case belong to none. Prints the names,
# to the file of NAMES if it is given.
#
#     awk [-v into=FOLDER/] [-v only=NAME] [-v kind=KIND] [-v rest=REST] [-v names=NAMES] -f cases.awk FILE.cases ...
/^=== / {
	if (file)
		close(file)
	name = into $2
	file = only == "" || only == $2 ? name "." (kind ? kind : "spec") : ""
	blank = ""
	if (file && names)
		print $2 >names
	else if (file)
		print $2
	next
}
FNR == 1 || file == "" { file = ""; next }
/^---$/ { close(file); file = name "." (rest ? rest : "rest"); blank = ""; next }
/^$/ { blank = blank "\n"; next }
{ printf "%s%s\n", blank, $0 >file; blank = "" }
