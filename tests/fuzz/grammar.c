/* SPDX-License-Identifier: GPL-3.0-or-later */
/* grammar SEED SPEC [C]: a valid spec of a small model, and what it says once more as C, both written from one tree of
 * random choices; the same for the same seed.  Lines of comment at its head are for grammar.sh:
 *     # options: of plgen, besides --rhs and --prefix
 *     # class: linear, piecewise (linear in each region), smooth or kinked (a remainder; kinked: a slope of it jumps)
 *     # changes: times at which a load changes its formula [s]
 *     # retune: NAME=VALUE ... step=VALUE, for models with tunable params
 * Outputs named inner... read what is between coordinates that move as a whole: they are judged by their own size.
 * Rates stay below some 10 rad/s and steps are short, so that each scheme is close to the solution.
 *
 * The C, for NAME given by -DNAME=...:
 *     NAME_residual(t, y, u, top, r)     left sides minus right sides; top: the highest derivative of each coordinate
 *     NAME_wanted(t, y, u, top, out)     the outputs; NULL `out` of a model without
 *     NAME_coords                        how many coordinates, then of each its order */
#include "grammar.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

uint64_t state;
static int tops, states;
static char *spec_outputs = "", *c_outputs = "";
static int outputs;

/* ---- outputs ---- */

static void output(const char *spec, const char *c)
{
	add(&spec_outputs, text("output %s\n", spec));
	add(&c_outputs, text("\tout[%d] = %s;\n", outputs++, c));
}

static void any_output(int n)
{
	const int i = below(coords), component = any_component(i);
		const struct both x = derivative(i, component, 0), a = derivative(i, component, coord[i].order),
						  w = any_state();
		struct both e;
	switch (below(9)) {
	case 0: case 1: e = JOIN("@ + @*@", x, fixed(0.5, 2), w); break;
	case 2: e = a; break;
	case 3: e = JOIN("2*@ - @ + t", a, w); break;
	case 4: e = inputs ? JOIN("@ + 0.5*@", sampled(), w) : JOIN("@ - 3.0*@", x, w); break;
	case 5: e = load(1); break;
	case 6: e = JOIN2("@^2 + sin(@)", "pow(@, 2) + sin(@)", x, w); break;
	case 7: e = JOIN2("max(@, @)", "fmax(@, @)", x, w); break;
	default: e = JOIN("@*@ + @", x, a, JOIN("exp(-@*t)", fixed(0.1, 1)));
	}
	if (tunable && strstr(e.c, "pow"))
		e = x;
	output(text("out%d = %s", n, e.spec), e.c);
}

static void write_inner(void)
{
	spec_outputs = spec_inner;
	c_outputs = c_inner;
	outputs = inners;
	for (int n = chance(50) ? below(3) : 0; n > 0; n--)
		any_output(n);
}

static void write_outputs(void)
{
	if (chance(35))
		return;
	if (chance(30))
		for (int i = 0; i < coords; i++) {
			if (!coord[i].size || !chance(50)) {
                            const struct both x = derivative(i, any_component(i), coord[i].order == 2 ? below(2) : 0);
							output(x.spec, x.c);
							continue;
			}
			for (int r = 0; r < coord[i].size; r++)
				add(&c_outputs, text("\tout[%d] = %s;\n", outputs++, derivative(i, r, 0).c));
			add(&spec_outputs, text("output %s\n", coord[i].name));
		}
	for (int n = 1 + below(3); n > 0; n--)
		any_output(n);
}

/* ---- options and statements ---- */

static const char *of_all(void)
{
	static const char *const scheme[] = { "etd1", "etdrk2", "etdrk4", "nc2", "nc3", "dq4", "bm3", "taylor",
					      "radau", "auto", "etdam4", "etdam5", "etdam6", "etdcol" };
	return scheme[below(sizeof scheme / sizeof *scheme)];
}

/* Those with a number stand in the spec. */
static char *scheme_statement(void)
{
	static const char *const scheme[] = { "taylor 12", "taylor 16", "taylor 12 over 3", "taylor 14 over 2",
		"radau 3", "radau 5", "radau 7", "auto 5", "auto 7", "etdcol 4", "etdcol 8" };
	static const char *const tolerance[] = { "1e-7", "1e-9", "1e-11" };
	char *const all = text("scheme %s\n", scheme[below(sizeof scheme / sizeof *scheme)]);
	return chance(50) ? all : text("%stolerance %s\n", all, tolerance[below(3)]);
}

/* The operator of a scheme with a remainder, sometimes. */
static char *operator_statement(void)
{
	if (class < SMOOTH || !chance(30))
		return "";
	const struct both x = any_state();
		switch (drive == TURNS_FAR ? 1
                                   : below(3)) { /* where one of a drive's states is fixed, all are kept as written */
		case 0: return text("operator at %s = %s\n", x.spec, chance(50) ? "0" : "0.2");
	case 1: return text("operator at t = 0.1\n");
	default: return text("operator at %s = -0.3, 0, 0.3, 0.6\n", x.spec);
		}
}

static char *options(const char *stated)
{
	char *all = "";
	if (chance(20))
		add(&all, " --real float");
	if (*stated)
		;
	else if (class >= SMOOTH ? chance(70) : !drive && chance(12))
		add(&all, text(" --scheme %s", !drive && chance(6) ? "pl" : of_all()));
	else if (!drive && chance(8))
		add(&all, chance(70) ? " --scheme exact" : " --scheme pl");
	if (class == LINEAR ? chance(30) : chance(2))
			add(&all,
                text(" --form %s", (const char *const[]){ "direct", "delta", "kick-drift-kick", "auto" }[below(4)]));
		if (class == LINEAR && states <= 16 && !tunable ? chance(18) : chance(1))
		add(&all, " --accuracy compensated");
	if (class == LINEAR && !tunable ? chance(20) : chance(2))
		add(&all, " --reduce");
	if (class == LINEAR ? chance(25) : chance(1))
		add(&all, " --selftest");
	if (chance(class >= SMOOTH ? 20 : 5))
		add(&all, " --loads remainder");
	if (chance(10))
		add(&all, text(" --step %s", (const char *const[]){ "0.01", "1/128", "0.0075" }[below(3)]));
	if (params && !tunable && chance(15))
		add(&all, text(" -D %s=%s", param[0].name, "1.25"));
	return all;
}

/* Names that other libraries have taken too. */
static const char *const odd[] = { "I",        "complex",  "NULL",  "errno", "math_errhandling",
								   "HUGE_VAL", "uint64_t", "x0",    "E",     "e1",
								   "lo",       "work",     "s",     "y",     "u",
								   "h",        "k",        "left",  "part1", "size",
								   "fabs",     "M_PI",     "i",     "q1",    "load1",
								   "phase",    "stdin",    "isnan", "NAN",   "signal",
								   "double_t", "a_dot" };

static void declare(void)
{
	static const char *const plain[] = { "x", "z", "theta", "w", "body", "a" };
	const int count = drive ? 0 : 1 + below(class == LINEAR ? 4 : 3);
	int used = 0;
	if (drive)
		declare_drive();
	for (int i = 0; i < count; i++) {
		struct coord *x = &coord[coords++];
		const bool far = class != PIECEWISE && !tunable && chance(10);
		x->name = chance(4) ? copy(odd[below((int)(sizeof odd / sizeof *odd))]) : copy(plain[used]);
		for (int j = 0; j < i; j++)
			if (strcmp(coord[j].name, x->name) == 0)
				x->name = copy(plain[used]);
		used++;
		x->order = chance(20) ? 1 : 2;
		x->size = chance(18) ? (far ? 9 + below(3) : 2 + below(2)) : 0;
		if (tunable && x->size > 2)
			x->size = 2;
	}
	if (!drive && below(2)) {         /* a first order alone is rare in the field */
		coord[0].order = 2;
	}
	for (int i = 0; i < coords; i++) {
		coord[i].first = states;
		coord[i].top = tops;
		states += coord[i].size ? coord[i].size : 1;
		tops += coord[i].size ? coord[i].size : 1;
	}
	for (int i = 0; i < coords; i++)
		if (coord[i].order == 2) {
			coord[i].velocity = states;
			states += coord[i].size ? coord[i].size : 1;
		}
	if (chance(30))
		for (inputs = 0; inputs == 0 || (inputs < 2 && chance(40)); inputs++) {
			input[inputs].name = copy(inputs ? "v_in" : "u_in");
			input[inputs].ramp = chance(50);
		}
}

static char *initial(void)
{
	char *all = "";
	const double slow = drive && class != LINEAR ? 0.0003 : 0.001;
	for (int i = 0; i < coords; i++)
		for (int primes = 0; primes < coord[i].order; primes++)
			for (int r = 0; r < (coord[i].size ? coord[i].size : 1); r++)
				if (drive == TURNS_FAR || (chance(70) && r < 3))
					add(&all, text("%s%s = %.3f", *all ? ", " : "init ",
						       derivative(i, coord[i].size ? r : -1, primes).spec,
						       (below(1201) - 600) * (primes ? 0.002 : slow) +
						       (drive == TURNS_FAR ? motion(i) * (primes ? 100 : 1e4) : 0)));
	return *all ? text("%s\n", all) : all;
}

/* What no expression reads */
static void write_unread(FILE *file)
{
	if (chance(6))
		fprintf(file, "param spare = 2, more = spare + 1\n");
	if (chance(4))
		fprintf(file, "param idle = 3\ntunable idle\n");
	if (chance(6))
		fprintf(file, "matrix still = [1, 2; 3, 4]\n");
}

static void write_spec(FILE *file, const char *of, const char *given, const char *operator, const char *stated)
{
	bool any = false;
	fprintf(file, "# options:%s\n# class: %s\n# changes:%s\n", given, of, changes);
	for (int i = 0; i < params; i++)
		any = any || param[i].tunable;
	if (any) {
		fprintf(file, "# retune:");
		for (int i = 0; i < params; i++)
			if (param[i].tunable)
				fprintf(file, " %s=%.4f", param[i].name, 0.6 + (double)below(3000) / 1000);
		if (class == LINEAR && !strstr(given, "--scheme"))      /* other schemes have the spec's step */
			fprintf(file, " step=%s", (const char *const[]){ "0.01", "0.03", "0.0625" }[below(3)]);
		fputc('\n', file);
	}
	fprintf(file, "model f\n");
	for (int i = 0; i < params; i++)
		fprintf(file, "param %s = %s\n", param[i].name, param[i].value);
	for (int i = 0; i < params; i++)
		if (param[i].tunable)
			fprintf(file, "tunable %s\n", param[i].name);
	for (int i = 0; i < coords; i++)
		fprintf(file, coord[i].size ? "coord %s[%d]\n" : "coord %s\n", coord[i].name, coord[i].size);
	for (int i = 0; i < inputs; i++)
		fprintf(file, "input %s%s\n", input[i].name, input[i].ramp ? " hold first" : "");
	write_unread(file);
	fprintf(file, "%s%s%s%s%s%s", initial(), spec_lets, operator, spec_equations, spec_outputs, stated);
	if (chance(6))
		fprintf(file, "let unread = %s + t\n", coord[0].size ? "2" : coord[0].name);
	fprintf(file, "step %s\n",
		(const char *const[]){ "0.01", "1/64", "0.0125", "0.02" }[below(class >= SMOOTH ? 3 : 4)]);
}

static void write_c(FILE *file, const char *given)
{
	char *names = "";
	for (int i = 0; i < params; i++) {
		const char *value = param[i].value;
		if (i == 0 && strstr(given, " -D "))
			value = "1.25";
		add(&names, text("\tconst double %s = %s;\n\t(void)%s;\n", param[i].name, value, param[i].name));
	}
	fprintf(file, "#include \"again.h\"\n\nconst int NAME(coords)[] = {%d", tops);
	for (int i = 0; i < coords; i++)
		for (int r = 0; r < (coord[i].size ? coord[i].size : 1); r++)
			fprintf(file, ", %d", coord[i].order);
	fprintf(file, "};\n\nvoid NAME(residual)(double t, const double *y, const double *u, const double *top, double "
	    "*r)\n{\n%s%s", names, c_lets);
	fprintf(file, "\t(void)t, (void)y, (void)u;\n%s}\n\n", c_rows);
		fprintf(file,
                "void NAME(wanted)(double t, const double *y, const double *u, const double *top, double *out)\n{\n"
				"%s%s",
				names, c_lets);
		fprintf(file, "\t(void)t, (void)y, (void)u, (void)top;\n");
	if (outputs)
		fprintf(file, "%s}\n", c_outputs);
	else
		fprintf(file, "\tfor (int i = 0; i < %d; i++)\n\t\tout[i] = y[i];\n}\n", states);
}

int main(int argc, char **argv)
{
	if (argc < 3) {
		fputs("usage: grammar SEED SPEC [C]\n", stderr);
		return 2;
	}
	state = strtoull(argv[1], NULL, 10) * UINT64_C(0x2545f4914f6cdd1d) + 7;
	const int kind = below(100);
	class = kind < 46 ? LINEAR : kind < 70 ? PIECEWISE : kind < 88 ? SMOOTH : KINKED;
	tunable = chance(class == LINEAR ? 25 : 15);
	drive = chance(50) ? GROUNDED : chance(50) ? TURNS : TURNS_FAR;
	declare();
	equations();
	if (drive && chance(80))
		write_inner();
	else
		write_outputs();
	const char *const operator = operator_statement(), *const stated = class >= SMOOTH && chance(20) ?
		scheme_statement() : "", *const given = options(stated);
	if (class != PIECEWISE && *changes && strstr(given, "--loads remainder"))
		class = KINKED;         /* the quadrature goes over the changes */
	FILE *const spec = fopen(argv[2], "w"), *const c = argc > 3 ? fopen(argv[3], "w") : NULL;
	if (!spec || (argc > 3 && !c)) {
		perror(argv[spec ? 3 : 2]);
		return 1;
	}
	write_spec(spec, (const char *const[]){ "linear", "piecewise", "smooth", "kinked" }[class], given, operator,
		stated);
	if (c)
		write_c(c, given);
	return fclose(spec) != 0 || (c && fclose(c) != 0);
}
