/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Models in which capabilities meet.
 *
 *     covering rows CAPABILITIES      a line for each model that must work: its capabilities.  Together they have every
 *                                     pair that is not refused, of the first ones every triple
 *     covering pairs CAPABILITIES     every pair that no group forbids: for who looks for refusals
 *     covering refused CAPABILITIES   a line for each set that is refused
 *     covering table CAPABILITIES     doc/combinations.md
 *     covering spec FILE.spec CAPABILITY ...   the model, with its options and what batch.sh asks for in comments
 *
 * What is refused, and why, is what gen/model/capability.def says of sets of up to three. The array is made greedily: a
 * row starts with the first set that is not covered yet, and takes what covers most of the others, as long as nothing
 * in it is refused. */
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 56, MOST_REFUSALS = 700, LINE = 1000, ROW = 10, PAGE = 118 };

/* ---- gen/model/capability.def ---- */

struct facts {
#define FACT(name, is) bool name;
#define STEP_FACT(name) bool name;
#define REQUESTED(name, words) bool name;
#include "model/capability.def"
};

static const struct { const char *name; size_t place; } fact[] = {
#define FACT(name, is) { #name, offsetof(struct facts, name) },
#define STEP_FACT(name) { #name, offsetof(struct facts, name) },
#define REQUESTED(name, words) { #name, offsetof(struct facts, name) },
#include "model/capability.def"
};
enum { FACTS = sizeof fact / sizeof *fact };

struct row { const char *asked, *words, *reason; };
static const struct row table[] = {
#define FIRST(format, ...) format
#define REQUESTED(name, words) { #name, words, NULL },
#define AGAINST(name, when, ...) { #name, NULL, FIRST(__VA_ARGS__, "") },
#include "model/capability.def"
};
enum { TABLE = sizeof table / sizeof *table };

/* The row of the table that stands against something of these; NULL: none does */
static const struct row *row_against(const struct facts *f)
{
	const struct row *at = table;
#define REQUESTED(name, words) at++;
#define AGAINST(name, when, ...) \
	if (f->name && (when)) \
		return at; \
	at++;
#include "model/capability.def"
	return NULL;
}

/* The message that a row makes; what it puts in stays %d and %s */
static void message_of(const struct row *row, char *text, size_t size)
{
	const struct row *words = row;
	while (!words->words)
		words--;
	const char *name = strstr(words->words, "$n");
	snprintf(text, size, "%.*s%s%s%s", (int)(name ? name - words->words : 0), words->words, name ? "NAME" : "",
		 name ? name + 2 : words->words, row->reason);
}

/* ---- what goes with what ---- */

static struct { char name[32], group[32], facts[64], words[120]; struct facts is; } capability[MOST];
static int count, first;
static struct { bool has[MOST]; int size; char reason[LINE]; } refusal[MOST_REFUSALS];
static int refusals;
static bool covered[MOST][MOST], tripled[MOST][MOST][MOST];

static void stop(const char *what, const char *which)
{
	fprintf(stderr, "covering: error: %s '%s'\n", what, which);
	exit(2);
}

static int number_of(const char *name)
{
	for (int i = 0; i < count; i++)
		if (strcmp(capability[i].name, name) == 0)
			return i;
	stop("unknown capability", name);
	return -1;
}

static FILE *need(const char *path)
{
	FILE *const file = fopen(path, "r");
	if (!file)
		stop("cannot read", path);
	return file;
}

static bool *fact_named(struct facts *facts, const char *name)
{
	for (int i = 0; i < FACTS; i++)
		if (strcmp(fact[i].name, name) == 0)
			return (bool *)((char *)facts + fact[i].place);
	stop("unknown fact", name);
	return NULL;
}

static void read_capability(const char *line)
{
	if (count == MOST || sscanf(line, "%31s %31s %63s %119[^\n]", capability[count].name, capability[count].group,
				    capability[count].facts, capability[count].words) != 4)
		stop("not a capability:", line);
	for (char *name = strtok(capability[count].facts, ","); name; name = strtok(NULL, ","))
		if (strcmp(name, "-") != 0)
			*fact_named(&capability[count].is, name) = true;
	count++;
}

static void read_refusal(char *line)
{
	char *const tab = line + strcspn(line, "\t");
	snprintf(refusal[refusals].reason, LINE, "%.*s", (int)strcspn(tab + 1, "\n"), tab + 1);
	*tab = 0;
	for (char *name = strtok(line, " "); name; name = strtok(NULL, " "), refusal[refusals].size++)
		refusal[refusals].has[number_of(name)] = true;
	refusals++;
}

/* All facts of a model with these, those too that follow from several */
static struct facts facts_of(const bool *row)
{
	struct facts f = { 0 };
	for (int i = 0; i < count; i++)
		for (int k = 0; k < FACTS && row[i]; k++) {
			const bool *const own = (const bool *)((const char *)&capability[i].is + fact[k].place);
			bool *const all = (bool *)((char *)&f + fact[k].place);
			*all = *all || *own;
		}
	f.contacts = f.has_dry_friction || f.bounces;
	/* a scheme leaves over what is piecewise linear; from event to event loads are not left over */
	f.left = f.left || (f.regions && f.approximates) || (f.recipe && !f.contacts);
	f.regions = f.regions && !f.left;
	f.cached = f.cached && f.regions;
	f.linear = !f.regions && !f.left;
	f.recipe = f.left && !f.normal && (f.approximates || (f.recipe && !f.contacts));
	f.curved = f.left;
	f.inexact = f.left || f.holds;
	f.measured = f.left || f.regions;
	f.series = f.series || (f.left && f.contacts && !(f.approximates || f.normal || f.collocation));
	f.projects = f.series || f.collocation || !(f.approximates || f.normal);        /* scheme exact has its line */
	f.tuned = f.tunable && !f.left;         /* else params are held, as inputs are */
	return f;
}

static bool excludes(int i, int j)
{
	return i != j && strcmp(capability[i].group, "-") != 0 && strcmp(capability[i].group, capability[j].group) == 0;
}

static bool is_refused(const bool *row)
{
	for (int r = 0; r < refusals; r++) {
		bool all = true;
		for (int i = 0; i < count && all; i++)
			all = !refusal[r].has[i] || row[i];
		if (all)
			return true;
	}
	return false;
}

/* Those of up to three capabilities that the table refuses, without what is refused within them */
static void find_refusals(void)
{
	for (int size = 1; size <= 3; size++)
		for (int i = 0; i < count; i++)
			for (int j = size < 2 ? i : 0; j <= (size < 2 ? i : i - 1); j++)
				for (int k = size < 3 ? j : 0; k <= (size < 3 ? j : j - 1); k++) {
					bool row[MOST] = { false };
					row[i] = row[j] = row[k] = true;
					const struct facts f = facts_of(row);
					const struct row *const against = row_against(&f);
					if (!against || is_refused(row) || excludes(i, j) || excludes(j, k) ||
					    excludes(i, k))
						continue;
					if (refusals == MOST_REFUSALS)
						stop("too many refusals", capability[i].name);
					memcpy(refusal[refusals].has, row, sizeof row);
					refusal[refusals].size = size;
					message_of(against, refusal[refusals++].reason, LINE);
				}
}

static void read_list(const char *capabilities)
{
	char line[LINE];
	FILE *const file = need(capabilities);
	while (fgets(line, sizeof line, file))
		if (strncmp(line, "---", 3) == 0)
			first = count;
		else if (*line == '!')
			read_refusal(line + 1);
		else if (*line != '#')
			read_capability(line);
	fclose(file);
	find_refusals();
}

static bool fits(bool *row, int i)
{
	for (int j = 0; j < count; j++)
		if (row[j] && excludes(i, j))
			return false;
	const bool before = row[i];
	row[i] = true;
	const bool good = !is_refused(row);
	row[i] = before;
	return good;
}

/* How much that is not covered yet the row has, with i where i is not in it. */
static int gain(const bool *row, int i)
{
	int sum = 0;
	for (int j = 0; j < count; j++) {
		if (!row[j])
			continue;
		sum += !covered[i][j];
		for (int k = 0; k < j && i < first && j < first; k++)
			sum += row[k] && !tripled[i][j][k];
	}
	return sum;
}

static void cover(const bool *row)
{
	for (int i = 0; i < count; i++)
		for (int j = 0; j < count; j++) {
			covered[i][j] = covered[i][j] || (row[i] && row[j]);
			for (int k = 0; k < count; k++)
				tripled[i][j][k] = tripled[i][j][k] || (row[i] && row[j] && row[k]);
		}
}

static void print_row(const bool *row)
{
	const char *before = "";
	for (int i = 0; i < count; i++)
		if (row[i]) {
			printf("%s%s", before, capability[i].name);
			before = " ";
		}
	putchar('\n');
}

/* Starts a row with i, j and k, where that can be. */
static bool start_row(bool *row, int i, int j, int k)
{
	memset(row, 0, MOST);
	row[i] = true;
	if (!fits(row, j))
		return false;
	row[j] = true;
	if (!fits(row, k))
		return false;
	row[k] = true;
	return !is_refused(row);
}

static void fill_row(bool *row)
{
	for (int size = 2; size < ROW; size++) {
		int best = -1, most = 0;
		for (int i = 0; i < count; i++)
			if (!row[i] && fits(row, i) && gain(row, i) > most) {
				most = gain(row, i);
				best = i;
			}
		if (best < 0)
			break;
		row[best] = true;
	}
	cover(row);
	print_row(row);
}

static void print_rows(void)
{
	bool row[MOST];
	for (int i = 0; i < first; i++)
		for (int j = 0; j < i; j++)
			for (int k = 0; k < j; k++)
				if (!tripled[i][j][k] && start_row(row, i, j, k))
					fill_row(row);
	for (int i = 0; i < count; i++)
		for (int j = 0; j <= i; j++)
			if (!covered[i][j] && start_row(row, i, j, j))
				fill_row(row);
}

static void print_pairs(void)
{
	for (int i = 0; i < count; i++)
		for (int j = 0; j <= i; j++)
			if (!excludes(i, j))
				printf(i == j ? "%s\n" : "%s %s\n", capability[j].name, capability[i].name);
}

static void print_refused(void)
{
	for (int r = 0; r < refusals; r++) {
		const char *before = "";
		for (int i = 0; i < count; i++)
			if (refusal[r].has[i]) {
				printf("%s%s", before, capability[i].name);
				before = " ";
			}
		printf("\t%s\n", refusal[r].reason);
	}
}

/* ---- the page ---- */

static const char *reasons[MOST_REFUSALS];
static int reasons_count;

static int reason_number(const char *reason)
{
	for (int i = 0; i < reasons_count; i++)
		if (strcmp(reasons[i], reason) == 0)
			return i + 1;
	reasons[reasons_count++] = reason;
	return reasons_count;
}

static const char *cell(int i, int j)
{
	static char text[32];
	if (excludes(i, j))
		return "";
	for (int r = 0; r < refusals; r++)
		if (refusal[r].has[i] && refusal[r].has[j] && refusal[r].size == (i == j ? 1 : 2)) {
			snprintf(text, sizeof text, "%d", reason_number(refusal[r].reason));
			return text;
		}
	return "+";
}

/* The text of an item of a list, which begins in this column, as lines of at most PAGE columns; a number that is put in
 * is N, a name X. */
static void print_words(char *text, int column)
{
	for (char *put = strchr(text, '%'); put; put = strchr(text, '%')) {
		*put = put[1] == 'd' ? 'N' : 'X';
		memmove(put + 1, put + 2, strlen(put + 1));
	}
	for (int at = column; *text;) {
		const int length = (int)strcspn(text, " ");
		if (at > column && at + 1 + length > PAGE) {
			printf("\n%*s", column, "");
			at = column;
		}
		at += printf("%s%.*s", at > column ? " " : "", length, text);
		text += length + (text[length] == ' ');
	}
	putchar('\n');
}

/* Columns and rows are known by letters and digits, so that a row fits on a line. */
static char letter(int i)
{
	return "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz123456789"[i];
}

static void print_pairs_table(void)
{
	fputs("| |", stdout);
	for (int j = 0; j < count; j++)
		printf("%c|", letter(j));
	fputs("\n| --- |", stdout);
	for (int j = 0; j < count; j++)
		fputs("-|", stdout);
	putchar('\n');
	for (int i = 0; i < count; i++) {
		printf("|%c %s|", letter(i), capability[i].name);
		for (int j = 0; j < count; j++)
			printf("%s|", j <= i ? cell(i, j) : "");
		putchar('\n');
	}
	puts("\n| |name|what it is|\n|-|---|---|");
	for (int i = 0; i < count; i++)
		printf("|%c|%s|%s|\n", letter(i), capability[i].name, capability[i].words);
}

static bool of_three(int r, int k)
{
	return refusal[k].size > 2 && strcmp(refusal[k].reason, refusal[r].reason) == 0;
}

/* The capabilities of all rows with the reason of r, unless one before has told them */
static void print_three(int r)
{
	char item[8 * LINE];
	bool together[MOST] = { false };
	for (int k = 0; k < refusals; k++)
		for (int i = 0; i < count; i++)
			if (of_three(r, k) && k < r)
				return;
			else if (of_three(r, k))
				together[i] = together[i] || refusal[k].has[i];
	snprintf(item, sizeof item, "%s:", refusal[r].reason);
	for (int i = 0; i < count; i++)
		if (together[i]) {
			strncat(item, " ", sizeof item - strlen(item) - 1);
			strncat(item, capability[i].name, sizeof item - strlen(item) - 1);
		}
	print_words(item, printf("- "));
}

static void print_refusals(void)
{
	puts("\n## Refusals\n");
	for (int i = 0; i < reasons_count; i++)
		print_words(strcpy((char[LINE]){ "" }, reasons[i]), printf("%d. ", i + 1));
	puts("\nRefused only with three or more together, of these names (`--pairs`, below, has each set):\n");
	for (int r = 0; r < refusals; r++)
		if (refusal[r].size > 2)
			print_three(r);
}

static void print_table(void)
{
	puts("<!-- SPDX-License-Identifier: GPL-3.0-or-later -->\n"
	     "# What goes with what\n\n"
	     "You want to know whether two features or options go together: a row and a column have the sign of\n"
	     "each. `+`: they work. A number: plgen refuses them with that message below, where N is a number and X\n"
	     "a name. Blank: one excludes the other. Every `+` is tested, by a covering array of pairs, against CVODE\n"
	     "or the closed form. An option that only makes a step faster stands aside with a note that says why.\n"
	     "`tests/combinations/combinations.sh` makes the page from `gen/model/capability.def`.\n");
	print_pairs_table();
	print_refusals();
	puts("\n## A new capability\n\n"
	     "A row for each refusal that it brings in `gen/model/capability.def`, a line in\n"
	     "`tests/combinations/capabilities.list`, and what it adds to a spec or the options in `write_spec` of\n"
	     "`covering.c`. `combinations.sh ... --pairs` prints the refusals that plgen has, `--table` this page.");
}

/* ---- a model ---- */

static int given;
static char **name;

static bool has(const char *one)
{
	for (int i = 0; i < given; i++)
		if (strcmp(name[i], one) == 0)
			return true;
	return false;
}

/* Those schemes bring what they are for */
static bool expands(void)
{
	return has("taylor") || has("taylor12") || has("over3") || has("radau") || has("auto");
}

static bool moves(void)
{
	return has("etdam5") || has("etdcol");
}

static void print_options(FILE *to)
{
	static const char *const option[][2] = { { "reduce", "--reduce" }, { "float", "--real float" },
		{ "compensated", "--accuracy compensated" }, { "direct", "--form direct" }, { "delta", "--form delta" },
		{ "kdk", "--form kick-drift-kick" },
		{ "modal", "--form modal" }, { "exact", "--scheme exact" }, { "pl", "--scheme pl" },
		{ "etd1", "--scheme etd1" }, { "etdrk2", "--scheme etdrk2" }, { "etdrk4", "--scheme etdrk4" },
		{ "nc2", "--scheme nc2" }, { "nc3", "--scheme nc3" }, { "dq4", "--scheme dq4" },
		{ "bm3", "--scheme bm3" }, { "taylor", "--scheme taylor" }, { "radau", "--scheme radau" },
		{ "auto", "--scheme auto" }, { "etdam5", "--scheme etdam5" }, { "etdcol", "--scheme etdcol" },
		{ "selftest", "--selftest" },
		{ "rows", "--rows 8" }, { "loads", "--loads remainder" }, { "refresh", "--refresh 8" },
		{ "batch", "--batch" } };
	bool scheme = false;
	fputs("# options:", to);
	for (size_t i = 0; i < sizeof option / sizeof *option; i++)
		if (has(option[i][0])) {
			fprintf(to, " %s", option[i][1]);
			scheme = scheme || strncmp(option[i][1], "--scheme", 8) == 0;
		}
	if (has("modes"))       /* all of them; what no output sees is left out */
		fprintf(to, " --modes %d", 2 + has("first") + has("parts") + (has("many") ? 7 : has("file") ? 3 : 0));
	scheme = scheme || has("taylor12") || has("over3");
	if (has("loads") && !scheme && !has("friction") && !has("impact"))
		fputs(" --scheme etdrk4", to);
	/* exact has no remainder that a load could be in */
	const bool kinks = has("kinked") || (has("loads") && has("change") && !has("exact"));
	const bool curves = kinks || has("smooth") || has("constraint") || has("implicit") || expands() || moves();
	fprintf(to, "\n# class: %s\n",
		has("friction")                      ? "sticking"
			: kinks                      ? "kinked"
			: has("piecewise") || has("impact") ? "piecewise"
			: curves                     ? "smooth"
						     : "linear");
	fputs(has("constraint") ? "# held: 1\n" : "", to);
	fprintf(to, "# changes:%s\n", has("change") ? " 0.053 0.1 0.21" : "");
	if (has("friction") || has("delayed"))  /* what a second model has, of which CVODE solves the equations */
		fprintf(to, "# instead: s/friction(b', 4)/max(-4, min(4, 40000*b'))/; "
			    "s/^# class: sticking/# class: %s/; "
			    "s/d(t - 0.02)/d_late/; s/^# whole: //\n", curves ? "kinked" : "piecewise");
	fputs(has("impact") ? "# impact: 0.02 0.8\n" : "", to);
	if (has("tunable"))
		fputs(has("smooth") || has("constraint") || has("kinked") || has("loads") || has("piecewise") ||
				has("friction") || has("implicit") ||
				has("impact") ||
		      expands() || moves() || has("delayed")
			? "# retune: k=17.5\n" : "# retune: k=17.5 step=0.0125\n", to);
}

static bool has_scheme(void)
{
	static const char *const scheme[] = { "exact", "pl", "etd1", "etdrk2", "etdrk4", "nc2", "nc3", "dq4", "bm3",
		"taylor", "taylor12", "radau", "auto", "etdam5", "etdcol" };
	bool any = false;
	for (size_t i = 0; i < sizeof scheme / sizeof *scheme; i++)
		any = any || has(scheme[i]);
	return any;
}

static void write_chain(FILE *to, int n)
{
	fprintf(to, "[");
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++)
			fprintf(to, "%s%d", j ? ", " : i ? "; " : "", i == j ? 16 : i == j + 1 || j == i + 1 ? -4 : 0);
	fprintf(to, "]\n");
}

/* So fine that what is chosen is compared as what is asked for is; a scheme that is asked for does what it can, and
 * the rounding of the form modal in float is bounded twelve times wider. Modes that only the part has would be left
 * out. */
static void write_need(FILE *to, const char *output)
{
	const bool measured = has("smooth") || has("constraint") || has("kinked") || has("piecewise") ||
			      has("implicit") || has("friction") || has("impact") || has("loads") || expands() ||
			      moves();
	fprintf(to, "need %s within %s until 0.5", output,
		measured && has_scheme() && !has("taylor") && !has("radau") ? "5 %"
			: has("float") ? has("modal") ? "5e-3" : "1e-4" : measured ? "1e-6" : "1e-9");
	fputs(has("held") || has("ramp") ? " for " : "", to);
	fprintf(to, "%s%s%s\n", has("held") ? "|u| <= 2" : "", has("held") && has("ramp") ? ", " : "",
		has("ramp") ? "|v| <= 2" : "");
}

/* Two masses and what else is asked for; without dampers where the form asks for that.  Frequencies: below 6 rad/s. */
static void write_spec(FILE *to)
{
	const bool vector = has("file") || has("many"), damped = !has("kdk");
	const bool outputs = has("accel") || has("nonlinear") || has("reduce") || has("modes") || has("peaks") ||
			     has("batch") || has("need");
	const int n = has("many") ? 7 : 3;
	print_options(to);
	fputs("model f\nparam k = 12\n", to);
	fputs(has("tunable") ? "tunable k\n" : "", to);
	if (has("parts"))
		fprintf(to, "use \"part.spec\" as p%s with k = k/3, x = 0.1%s%s\n", outputs ? ", unused" : "",
			has("cos") ? ", pull = cos(4*t)" : ", pull = 0",
			damped ? "" : ", m = 1");
	fputs("coord a, b\n", to);
	fputs(has("sensitivity") ? "sensitivity k, a\n" : "", to);
	fputs(has("constraint") ? "coord c, g\n" : "", to);
	fputs(has("implicit") ? "coord w\n" : "", to);
	fputs(has("first") ? "coord z\n" : "", to);
	fputs(has("reduce") ? "coord unseen\n" : "", to);
	if (vector)
		fprintf(to, "coord q[%d]\n", n);
	fputs(has("cached") ? "regions cached 3\n" : "", to);
	fputs(has("delayed") ? "input d\n" : "", to);
	fputs(has("held") ? "input u\n" : "", to);
	fputs(has("ramp") ? "input v hold first\n" : "", to);
	fputs(has("delayed") ? "# whole: input d_late\n" : "", to);
	fprintf(to, "init a = 0.2, b' = 0.5%s%s%s\n", has("constraint") ? ", c = 0.6, g = 0.8" : "",
		has("first") ? ", z = 0.3" : "", vector ? ", q[2] = 0.1" : "");
	if (vector) {
		fputs("matrix K = ", to);
		if (has("file"))
			fprintf(to, "\"chain%d.mtx\"\n", n);
		else
			write_chain(to, n);
		fputs("matrix e = [1", to);
		for (int i = 1; i < n; i++)
			fprintf(to, "; %d", i % 2);
		fputs("]\n", to);
	}
	if (has("parts") && !has("rigid"))
		fprintf(to, "spring k/4 between p.x, b\n%s", damped ? "damper 0.2 between p.x, b\n" : "");
	fprintf(to, "%sa''%s + k*(a - b)%s = ", damped ? "2*" : "", damped ? " + 0.3*(a' - b')" : "",
	        has("rigid") ? "" : " + 30*a");
	fputs(has("cos") || has("loads") ? "3*cos(7*t) + " : "", to);
	fputs(has("change") ? "(t < 0.1 ? 4 : 1) + " : "", to);
	fputs(has("held") ? "2*u + " : "", to);
	fputs(has("delayed") ? "2*d(t - 0.02) + " : "", to);
	fputs(has("ramp") ? "3*v + " : "", to);
	fputs("0\n", to);
	fprintf(to, "b''%s%s + k*(b - a) = ", damped ? " + 0.3*(b' - a')" : "",
		has("friction") ? " + friction(b', 4)" : "");
	fputs(has("power") ? "5*t^3 + " : "", to);
	fputs(has("piecewise") ? "-9*max(b - 0.1, 0) + " : "", to);
	fputs(has("smooth") || expands() ? "-2*b^3 + " : "", to);
	fputs(moves() ? "-2*cos(1.5*t)*b + " : "", to);
	fputs(has("kinked") ? "-3*abs(b)*b' + " : "", to);
	fputs(has("ramp") ? "0.05*v' + " : "", to);
	fputs("0\n", to);
	fputs(has("constraint") ? "c'' + 4*c = 0\n2*g'' + k*g = 0\nspring 2 between b, c\n"
				  "constraint rod: c^2 + g^2 = 1\n" : "", to);
	fputs(has("implicit") ? "w'' + 0.05*w''^3 + 4*w = 0\nspring 2 between b, w\n" : "", to);
	fputs(has("first") ? "0.5*z' + 2*z = a - b\n" : "", to);
	fputs(has("reduce") ? "unseen'' + 5*unseen = 0\n" : "", to);
	if (vector) {
		fprintf(to, "q''%s + K*q = ", damped ? " + 0.2*q'" : "");
		fputs(has("cos") || has("change") ? "e*(" : "", to);
		fputs(has("cos") ? "cos(7*t) + " : "", to);
		fputs(has("change") ? "table(t; 0.053, 0; 0.1, 2; 0.21, 1) + " : "", to);
		fputs(has("cos") || has("change") ? "0)\n" : "0\n", to);
		fputs("spring 2 between b, q[1]\n", to);
	}
	if (outputs)
		fprintf(to, "output a, b%s%s%s\n", has("first") ? ", z" : "", vector ? ", q[1], q[3]'" : "",
		        has("parts") ? ", p.speed" : "");
	if (has("accel"))
		fprintf(to, "output a'', s = 2*b'' - a%s%s\n", has("first") ? " + z'" : "",
			has("constraint") ? ", rod" : "");
	fputs(has("peaks") ? "output wave = a + 0.5*b, top = peak(a + 0.5*b)\n" : "", to);
	fputs(has("nonlinear") ? "output r = a^2 + sin(b)*b'\n" : "", to);
	fputs(has("impact") ? "when b >= 0.02: b' = -0.8*b'\n" : "", to);
	fputs(has("taylor12") ? "scheme taylor 12\n" : "", to);
	fputs(has("over3") ? "scheme taylor 12 over 3\n" : "", to);
	if (has("need"))
		write_need(to, has("accel") ? "s" : "a");
	if (has("need") && has("parts") && has("rigid"))
		write_need(to, "p.speed");
	fputs("step 0.01\n", to);
}

int main(int argc, char **argv)
{
	if (argc >= 3 && strcmp(argv[1], "spec") == 0) {
		FILE *const to = fopen(argv[2], "w");
		if (!to)
			stop("cannot write", argv[2]);
		given = argc - 3;
		name = argv + 3;
		write_spec(to);
		return fclose(to) != 0;
	}
	if (argc != 3)
		stop("usage: covering rows|pairs|refused|table CAPABILITIES, or spec FILE.spec CAPABILITY ..., not",
			argc > 1 ? argv[1] : "");
	read_list(argv[2]);
	if (strcmp(argv[1], "rows") == 0)
		print_rows();
	else if (strcmp(argv[1], "pairs") == 0)
		print_pairs();
	else if (strcmp(argv[1], "refused") == 0)
		print_refused();
	else if (strcmp(argv[1], "table") == 0)
		print_table();
	else
		stop("no such use", argv[1]);
	return ferror(stdout) != 0 || fflush(stdout) != 0;
}
