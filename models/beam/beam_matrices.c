/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The matrices of a flexible cantilever that turns in its plane, as Matrix Market files.
 *
 *     M q'' + 2 w G q' + [K + w^2 (D - M) + w' G] q = w^2 fu - w' fw            w: speed of rotation
 *
 * Euler-Bernoulli beam clamped on the axis of rotation, first-order stiffening theory: the model of Fang, Wang and Guo
 * (exponential time differencing for a rotating flexible beam), whose own matrices did not survive; these are deduced.
 * In the turning frame u is along the beam, on linear shape functions, and v across it, on Hermite's cubics; D is what
 * the shortening of a bent beam does in the centrifugal field.  Coordinates [u1 v1 t1 u2 v2 t2 ...] of the nodes behind
 * the clamped root, t = dv/dx. M, K and D are symmetric, G antisymmetric.
 *
 *     cc -o beam_matrices beam_matrices.c -lm && ./beam_matrices            (M.mtx, K.mtx, G.mtx, D.mtx, fu.mtx,
 * fw.mtx)
 */
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LIMIT_ELEMENTS = 1000000 };
enum { REACH = 5, BAND = 2 * REACH + 1 };       /* coordinates i and j of one element: |i - j| <= 5 */

struct beam {
	long elements;
	double L, S, I, rho, E;                 /* m, m^2, m^4, kg/m^3, Pa */
};

/* Row i holds columns i - REACH .. i + REACH. */
struct matrix {
	const char *name;
	const char *meaning;
	bool symmetric;
	long rows;
	double (*band)[BAND];
};

struct vector {
	const char *name;
	const char *meaning;
	long rows;
	double *cell;
};

struct system {
	struct matrix M, K, G, D;
	struct vector fu, fw;
};

static void fail(int status, const char *text, const char *subject)
{
	fprintf(stderr, "beam_matrices: %s%s\n", text, subject);
	exit(status);
}

/* ---- elements ---- */

/* Within an element: [u v t] of its left node, then of its right one. */
static const int axial[2] = { 0, 3 }, lateral[4] = { 1, 2, 4, 5 };

struct element {
	long left;              /* global number of coordinate 0; negative for the clamped root */
	double l, x;            /* length; position of the left end */
	double scale[4];        /* of the lateral coordinates: a rotation counts as a displacement over l */
};

static struct element element(const struct beam *b, long number)
{
	const double l = b->L / (double)b->elements;
	return (struct element){ 3 * (number - 1), l, b->L * (double)number / (double)b->elements, { 1, l, 1, l } };
}

static void add(struct matrix *matrix, const struct element *e, int row, int column, double value)
{
	const long i = e->left + row, j = e->left + column;
	if (i >= 0 && j >= 0)
		matrix->band[i][j - i + REACH] += value;
}

static void add_axial(struct matrix *matrix, const struct element *e, double factor, double own, double other)
{
	for (int i = 0; i < 2; i++)
		for (int j = 0; j < 2; j++)
			add(matrix, e, axial[i], axial[j], factor * (i == j ? own : other));
}

static void add_lateral(struct matrix *matrix, const struct element *e, double factor, const int table[4][4])
{
	for (int i = 0; i < 4; i++)
		for (int j = 0; j < 4; j++)
			add(matrix, e, lateral[i], lateral[j], factor * table[i][j] * (e->scale[i] * e->scale[j]));
}

static void add_load(struct vector *vector, const struct element *e, int row, double value)
{
	if (e->left + row >= 0)
		vector->cell[e->left + row] += value;
}

static void mass(struct system *s, const struct beam *b, const struct element *e)
{
    static const int table[4][4] = { { 156, 22, 54, -13 },
                                     { 22, 4, 13, -3 },
                                     { 54, 13, 156, -22 },
                                     { -13, -3, -22, 4 } };
    add_axial(&s->M, e, b->rho * b->S * e->l / 6, 2, 1);
    add_lateral(&s->M, e, b->rho * b->S * e->l / 420, table);
}

static void stiffness(struct system *s, const struct beam *b, const struct element *e)
{
	static const int table[4][4] = { { 12, 6, -12, 6 }, { 6, 4, -6, 2 }, { -12, -6, 12, -6 }, { 6, 2, -6, 4 } };
	add_axial(&s->K, e, b->E * b->S / e->l, 1, -1);
	add_lateral(&s->K, e, b->E * b->I / (e->l * e->l * e->l), table);
}

/* rho S integral of (lateral shape)(axial shape); its negative transpose in the axial rows */
static void gyroscopic(struct system *s, const struct beam *b, const struct element *e)
{
	static const int table[4][2] = { { 21, 9 }, { 3, 2 }, { 9, 21 }, { -2, -3 } };
	for (int i = 0; i < 4; i++)
		for (int j = 0; j < 2; j++) {
			const double value = b->rho * b->S * e->l / 60 * table[i][j] * e->scale[i];
			add(&s->G, e, lateral[i], axial[j], value);
			add(&s->G, e, axial[j], lateral[i], -value);
		}
}

/* rho S/2 integral of (L^2 - x^2) N'^T N' dx.  With x = x0 + l z and N' taken with respect to z, the tables are the
 * integrals from 0 to 1 of N'^T N' times 1, z, z^2, times 30, 60, 210. */
static void stiffening(struct system *s, const struct beam *b, const struct element *e)
{
	static const int z0[4][4] = { { 36, 3, -36, 3 }, { 3, 4, -3, -1 }, { -36, -3, 36, -3 }, { 3, -1, -3, 4 } };
	static const int z1[4][4] = { { 36, 6, -36, 0 }, { 6, 2, -6, -1 }, { -36, -6, 36, 0 }, { 0, -1, 0, 6 } };
	static const int z2[4][4] = { { 72, 15, -72, -6 }, { 15, 4, -15, -3 }, { -72, -15, 72, 6 }, { -6, -3, 6, 18 } };
	const double factor = b->rho * b->S / (2 * e->l);
	add_lateral(&s->D, e, factor * (b->L - e->x) * (b->L + e->x) / 30, z0);
	add_lateral(&s->D, e, -factor * 2 * e->x * e->l / 60, z1);
	add_lateral(&s->D, e, -factor * e->l * e->l / 210, z2);
}

/* rho S integral of x times the shapes */
static void loads(struct system *s, const struct beam *b, const struct element *e)
{
	static const int length[4] = { 9, 2, 21, -3 }, left_end[4] = { 30, 5, 30, -5 };
	const double factor = b->rho * b->S * e->l;
	add_load(&s->fu, e, axial[0], factor / 6 * (e->l + 3 * e->x));
	add_load(&s->fu, e, axial[1], factor / 6 * (2 * e->l + 3 * e->x));
	for (int i = 0; i < 4; i++)
		add_load(&s->fw, e, lateral[i], factor / 60 * (length[i] * e->l + left_end[i] * e->x) * e->scale[i]);
}

static void *zeros(long count, size_t size)
{
	void *block = calloc((size_t)count, size);
	if (!block)
		fail(1, "out of memory", "");
	return block;
}

static struct matrix matrix(const char *name, const char *meaning, bool symmetric, long rows)
{
	return (struct matrix){ name, meaning, symmetric, rows, zeros(rows, sizeof(double[BAND])) };
}

static struct vector vector(const char *name, const char *meaning, long rows)
{
	return (struct vector){ name, meaning, rows, zeros(rows, sizeof(double)) };
}

static struct system assemble(const struct beam *b)
{
	const long rows = 3 * b->elements;
        struct system s = { matrix("M", "mass", true, rows),
                            matrix("K", "stiffness", true, rows),
                            matrix("G", "gyroscopic, antisymmetric", false, rows),
                            matrix("D", "stiffening by the centrifugal field, over w^2", true, rows),
                            vector("fu", "axial load, over w^2", rows),
                            vector("fw", "lateral load, over -w'", rows) };
        for (long number = 0; number < b->elements; number++) {
		const struct element e = element(b, number);
		mass(&s, b, &e);
		stiffness(&s, b, &e);
		gyroscopic(&s, b, &e);
		stiffening(&s, b, &e);
		loads(&s, b, &e);
	}
	return s;
}

/* ---- files ---- */

/* The fewest digits that read back as the same double. */
static void print_number(FILE *file, double value)
{
	char text[40];
	for (int digits = 15; digits <= 17; digits++) {
		snprintf(text, sizeof text, "%.*g", digits, value);
		if (strtod(text, NULL) == value)
			break;
	}
	fputs(text, file);
}

static void print_head(FILE *file, const struct beam *b, const char *kind, const char *name, const char *meaning)
{
	const struct { const char *name; double value; } parameter[] = {
		{ "L", b->L }, { "S", b->S }, { "I", b->I }, { "rho", b->rho }, { "E", b->E }
	};
        fprintf(file, "%%%%MatrixMarket matrix %s\n%% %s: %s; made by beam_matrices: %ld elements", kind, name, meaning,
                b->elements);
        for (size_t i = 0; i < sizeof parameter / sizeof *parameter; i++) {
		fprintf(file, ", %s = ", parameter[i].name);
		print_number(file, parameter[i].value);
	}
	fputc('\n', file);
}

static FILE *create(const char *prefix, const char *name, char **path)
{
	*path = zeros((long)(strlen(prefix) + strlen(name) + 5), 1);
	sprintf(*path, "%s%s.mtx", prefix, name);
	FILE *file = fopen(*path, "w");
	if (!file) {
		fprintf(stderr, "beam_matrices: cannot write '%s': %s\n", *path, strerror(errno));
		exit(1);
	}
	return file;
}

/* A file that could not be written whole does not stay. */
static void complete(FILE *file, char *path)
{
	errno = 0;
	bool failed = ferror(file) || fflush(file) != 0;
	int why = errno;
	if (fclose(file) != 0 && !failed) {
		failed = true;
		why = errno;
	}
	if (failed) {
		fprintf(stderr, "beam_matrices: cannot write '%s': %s\n", path, why ? strerror(why) : "write error");
		remove(path);
		exit(1);
	}
	free(path);
}

/* Columns that row i has, of a symmetric matrix those up to the diagonal. */
static long first_column(long i)
{
	return i > REACH ? i - REACH : 0;
}

static long last_column(const struct matrix *m, long i)
{
	return m->symmetric ? i : i + REACH < m->rows ? i + REACH : m->rows - 1;
}

static long entries(const struct matrix *m)
{
	long count = 0;
	for (long i = 0; i < m->rows; i++)
		for (long j = first_column(i); j <= last_column(m, i); j++)
			count += m->band[i][j - i + REACH] != 0;
	return count;
}

static void write_matrix(const struct beam *b, const struct matrix *m, const char *prefix)
{
	char *path;
	FILE *file = create(prefix, m->name, &path);
        print_head(file, b, m->symmetric ? "coordinate real symmetric" : "coordinate real general", m->name,
                   m->meaning);
        fprintf(file, "%ld %ld %ld\n", m->rows, m->rows, entries(m));
	for (long i = 0; i < m->rows; i++)
		for (long j = first_column(i); j <= last_column(m, i); j++) {
			const double value = m->band[i][j - i + REACH];
			if (value == 0)
				continue;
			fprintf(file, "%ld %ld ", i + 1, j + 1);
			print_number(file, value);
			fputc('\n', file);
		}
	complete(file, path);
}

static void write_vector(const struct beam *b, const struct vector *v, const char *prefix)
{
	char *path;
	FILE *file = create(prefix, v->name, &path);
	print_head(file, b, "array real general", v->name, v->meaning);
	fprintf(file, "%ld 1\n", v->rows);
	for (long i = 0; i < v->rows; i++) {
		print_number(file, v->cell[i]);
		fputc('\n', file);
	}
	complete(file, path);
}

/* Reasonable parameters can still have a product that is beyond a double. */
static void check_matrix(const struct matrix *m)
{
	for (long i = 0; i < m->rows; i++)
		for (int k = 0; k < BAND; k++)
			if (!isfinite(m->band[i][k]))
				fail(1, "these parameters leave the range of double in ", m->name);
}

/* M and K are positive definite: no zero on the diagonal, unless it underflowed. */
static void check_diagonal(const struct matrix *m)
{
	for (long i = 0; i < m->rows; i++)
		if (!(m->band[i][REACH] > 0))
			fail(1, "these parameters leave the range of double in ", m->name);
}

static void check_vector(const struct vector *v)
{
	for (long i = 0; i < v->rows; i++)
		if (!isfinite(v->cell[i]))
			fail(1, "these parameters leave the range of double in ", v->name);
}

/* ---- the command ---- */

static void usage(FILE *file)
{
	fputs("usage: beam_matrices [options] [PREFIX]\n"
		"Writes PREFIXM.mtx, K, G, D, fu, fw: a rotating cantilever (Euler-Bernoulli, 3 coordinates a node).\n"
		"  -n ELEMENTS   5\n"
		"  -L LENGTH     8 m\n"
		"  -S AREA       7.2968e-5 m^2\n"
		"  -I INERTIA    8.2189e-9 m^4, second moment of area\n"
		"  -r DENSITY    2766.7 kg/m^3\n"
		"  -E MODULUS    6.8952e10 Pa\n"
		"  --help\n", file);
}

static double positive(const char *option, const char *text)
{
	char *end;
	const double value = strtod(text, &end);
	if (end == text || *end || !isnormal(value) || value < 0) {
		fprintf(stderr, "beam_matrices: option %s wants a positive number, found '%s'\n", option, text);
		exit(2);
	}
	return value;
}

static long count(const char *option, const char *text)
{
	char *end;
	const long value = strtol(text, &end, 10);
	if (end == text || *end || value < 1 || value > LIMIT_ELEMENTS) {
            fprintf(stderr, "beam_matrices: option %s wants a whole number from 1 to %d, found '%s'\n", option,
                    LIMIT_ELEMENTS, text);
            exit(2);
	}
	return value;
}

static void option(struct beam *b, const char *name, const char *text)
{
	if (name[1] == '\0' || name[2] != '\0' || !strchr("nLSIrE", name[1])) {
		usage(stderr);
		fail(2, "unknown option ", name);
	}
	if (!text)
		fail(2, "a value is missing after ", name);
	switch (name[1]) {
	case 'n': b->elements = count(name, text); break;
	case 'L': b->L = positive(name, text); break;
	case 'S': b->S = positive(name, text); break;
	case 'I': b->I = positive(name, text); break;
	case 'r': b->rho = positive(name, text); break;
	case 'E': b->E = positive(name, text); break;
	}
}

int main(int argc, char **argv)
{
	struct beam b = { 5, 8, 7.2968e-5, 8.2189e-9, 2.7667e3, 6.8952e10 };
	const char *prefix = NULL;
	for (int i = 1; i < argc; i++) {
		if (strcmp(argv[i], "--help") == 0) {
			usage(stdout);
			return fflush(stdout) != 0;
		}
		if (argv[i][0] == '-') {
			option(&b, argv[i], i + 1 < argc ? argv[i + 1] : NULL);
			i++;
		} else if (prefix) {
			fail(2, "one PREFIX only, but there is also ", argv[i]);
		} else {
			prefix = argv[i];
		}
	}
	if (!prefix)
		prefix = "";

	struct system s = assemble(&b);
	const struct matrix *matrices[] = { &s.M, &s.K, &s.G, &s.D };
	const struct vector *vectors[] = { &s.fu, &s.fw };
	for (int i = 0; i < 4; i++)
		check_matrix(matrices[i]);
	for (int i = 0; i < 2; i++)
		check_vector(vectors[i]);
	check_diagonal(&s.M);
	check_diagonal(&s.K);
	for (int i = 0; i < 4; i++)
		write_matrix(&b, matrices[i], prefix);
	for (int i = 0; i < 2; i++)
		write_vector(&b, vectors[i], prefix);
	for (int i = 0; i < 4; i++)
		free(matrices[i]->band);
	for (int i = 0; i < 2; i++)
		free(vectors[i]->cell);
	return 0;
}
