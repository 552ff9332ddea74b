/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Polynomials, poles, residues, e^{A tau}: exact and enclosed. Knows no model. */
#ifndef PLGEN_MATH_H
#define PLGEN_MATH_H

#include "base/base.h"

#include <limits.h>

/* ---- matrix.c: rational matrices, and integer ones ---- */

/* The block of each row (0 .. n-1) and column (n .. 2n-1) of an n x n matrix, numbered in the order of their first
 * columns; how many there are: rows and columns that have nothing in common with those of others */
int  matrix_blocks(int n, const bool *filled, int *block);
/* Components of a graph by parent pointers, at first numbers_up_to */
int  root_of_node(int *parent, int node);                   /* of its component: paths to it become shorter */
void join_nodes(int *parent, int a, int b);                 /* their components become one */
/* Fraction-free elimination (Bareiss): on W of width n the determinant; on [W | I], after Jordan, also adj W in the
 * place of I. False at a singular matrix: *column depends on those before it. */
bool bareiss(int n, int width, mpz_t *W, mpz_ptr det, int *column);

bool rational_inverse(int n, const mpq_t *A, mpq_t *inverse, int *column); /* false: singular, *column free */
struct last_inverse { int n; mpq_t *A, *inverse; };
bool inverse_kept(struct last_inverse *last, int n, const mpq_t *A, int *column); /* the same; A may be the last one */
bool rational_symmetric(int n, const mpq_t *A);
/* numerators and denominators that may have factors in common: for who only rounds them */
void unreduced_product(int rows, int inner, int columns, const mpq_t *A, const mpq_t *B, mpq_t *AB);
void rational_product(int rows, int inner, int columns, const mpq_t *A, const mpq_t *B, mpq_t *AB);

/* ---- echelon.c: rows of rationals that come one by one ---- */

struct echelon {                    /* reduced: a pivot stands alone in its column */
	int width, rank;
	mpq_t **row;
	int *pivot;
};

void rational_subtract_row(int n, mpq_t *target, const mpq_t *row, mpq_srcptr factor); /* target - factor row */
struct echelon echelon_new(int width);
void echelon_add(struct echelon *e, mpq_t *row);            /* `row` is used up */
void echelon_pivot(struct echelon *e, int r, int pivot);    /* row r gets another pivot */
/* A basis of what all rows annihilate: one vector for each column without pivot, 1 there; returns how many */
int  echelon_null_space(const struct echelon *e, mpq_t ***basis);

/* ---- eigenvalues.c ---- */

/* in double precision; false: not found */
bool eigenvalues(int n, const mpq_t *A, double *re, double *im);

double spectral_radius(int n, const double *A);             /* of n x n; infinite where none is found */
/* x of A x = b, n x n, by elimination with pivots in double precision; A goes, b becomes x. False: A is singular, as
 * far as that precision tells, and x may not be finite */
bool solve_complex(int n, double _Complex *A, double _Complex *b);

/* ---- symmetric.c: K v = lambda M v of symmetric K and positive definite M, in multiprecision ---- */

struct eigenpairs {
	int n, blocks;
	mpfr_t *value;              /* those of a block after each other, rising */
	mpfr_t *vector;             /* n x n, a column each: V^T M V = I, V^T K V diagonal; 0 outside its block */
	int *block;                 /* per pair: 0 .. blocks - 1; what no entry of M and K couples are blocks */
};
/* Residuals below 2^-precision of what they are sums of; false: M is not positive definite. n x n, symmetric */
bool symmetric_eigenpairs(int n, const mpq_t *M, const mpq_t *K, int precision, struct eigenpairs *pairs);

/* ---- invariant.c, subspace.c: the smallest real invariant subspaces, right and left ---- */

struct invariants;
struct invariant {                  /* of eigenvalues that lie together, with their conjugates */
	int columns;                /* of its basis: 1 of a real eigenvalue, 2 of a pair of complex ones, or more */
	double re, im;              /* the middle of those in the upper half plane, im >= 0 */
	bool real;                  /* its eigenvalues are real, or as good as */
	int members, first;         /* invariant.c */
};
/* Of a square A, which stays: in double precision, by rising size of eigenvalues. A basis of one column, or pair, is 1
 * in the largest of its `leading` first entries. NULL: not found */
struct invariants *invariants_of(int n, const mpq_t *A, int leading);
/* of A = M^-1 K of symmetric M, positive definite, and K */
struct invariants *invariants_symmetric(int n, const mpq_t *A, const mpq_t *M, const mpq_t *K);
int invariants_count(const struct invariants *of);
const struct invariant *invariant_part(const struct invariants *of, int part);
/* X and Y, n x columns, as first found: A X = X T, A^T Y = Y T^T, Y^T X = 1. Of a complex p with eigenvector v columns
 * are Re v and Im v, T = [Re p, Im p; -Im p, Re p]. */
void invariant_start(const struct invariants *of, int part, double *X, double *Y);
/* T, X and Y^T (columns x n), each number to about so many bits of the largest of its column; what is no larger than
 * what they may be wrong by is 0. False: the start is too far off. */
bool invariant_refine(struct invariants *of, int part, int bits, mpq_t *block, mpq_t *right, mpq_t *left);

/* ---- poly.c: polynomials over Z, constant term first ---- */

struct poly {
	int length;                 /* degree + 1; 0 is the zero polynomial; the last coefficient is not 0 */
	mpz_t *c;
};
struct poly poly_new(int length);                           /* coefficients 0; call poly_trim after filling */
void poly_trim(struct poly *p);
struct poly poly_add(struct poly a, struct poly b);
struct poly poly_sub(struct poly a, struct poly b);
struct poly poly_mul(struct poly a, struct poly b);
struct poly poly_product(int count, const struct poly *factor);
struct poly poly_scale(struct poly a, mpz_srcptr factor);
struct poly poly_shift(struct poly a, int powers);          /* times s^powers; negative: exact division */
/* b divides a exactly, over Q; primitive up to a factor: see .c */
struct poly poly_divide(struct poly a, struct poly b);
struct poly poly_gcd(struct poly a, struct poly b);         /* primitive, leading coefficient positive */
struct poly poly_derivative(struct poly a);
struct poly poly_hasse(struct poly a, int k);               /* k-th derivative over k! */
struct poly poly_mirror(struct poly a);                     /* a(-s) */
/* a = content * result, result's leading coefficient positive */
struct poly poly_primitive(struct poly a, mpz_ptr content);
bool poly_divides(struct poly d, struct poly a);            /* d | a over Q */
bool poly_equal(struct poly a, struct poly b);
int  poly_valuation(struct poly a);                         /* how often s divides a (not 0) */

struct factor {                     /* square-free, no root at 0 */
	struct poly g;
	int multiplicity;
	bool symmetric;             /* g(s) = +-g(-s): for every root its negative */
};
int poly_square_free(struct poly a, struct factor **factors); /* a primitive; roots at 0 left out; returns the count */

/* ---- polymat.c: square matrices of polynomials ---- */

struct polymat {
	int n;
	struct poly *cell;          /* row-major */
};
/* det P not the zero polynomial; adj may be NULL, its n x n cells are filled in */
/* Those of the blocks that have nothing in common: det P is their product; how many there are */
int  polymat_determinants(struct polymat P, struct poly **det);
void polymat_adjugate(struct polymat P, struct poly *det, struct polymat *adj);

/* ---- enclosure.c: complex numbers enclosed in rectangles; targets may be operands ---- */

struct rectangle { mpfi_t re, im; };
void rectangle_init(struct rectangle *z, int precision);    /* 0 */
struct rectangle new_rectangle(int precision);             /* 0 */
#define RECTANGLE __attribute__((cleanup(rectangle_clear))) struct rectangle /* RECTANGLE z = new_rectangle(64); */
void rectangle_clear(struct rectangle *z);
void rectangle_set(struct rectangle *z, const struct rectangle *a);
void rectangle_sub(struct rectangle *z, const struct rectangle *a, const struct rectangle *b);
void rectangle_mul(struct rectangle *z, const struct rectangle *a, const struct rectangle *b);
void rectangle_real_product(mpfi_ptr re, const struct rectangle *a, const struct rectangle *b);
void rectangle_div(struct rectangle *z, const struct rectangle *a, const struct rectangle *b);
void rectangle_exp(struct rectangle *z, const struct rectangle *a, mpq_srcptr tau);         /* e^{a tau} */
void rectangle_evaluate(struct rectangle *z, struct poly p, const struct rectangle *a);     /* p(a); z is not a */

/* ---- rectangles.c: vectors and matrices of them ---- */

#define NO_SIZE (LONG_MIN / 8)                              /* of what is exactly 0 */
struct rectangle *rectangles(int count, int precision);     /* 0 */
#define RECTANGLES __attribute__((cleanup(clear_rectangles))) struct rectangle /* RECTANGLES *z = rectangles(n, 64); */
void clear_rectangles(struct rectangle **z);
long interval_size(mpfi_srcptr x);                          /* about log2 of it */
long rectangle_size(const struct rectangle *z);
void rectangle_add_product(struct rectangle *z, const struct rectangle *a, const struct rectangle *b); /* z + a b */
void rectangle_add_scaled(struct rectangle *z, const struct rectangle *a, mpq_srcptr factor); /* z + factor a */
/* v of P v = 0, of an n x n matrix P of rank n - 1, destroyed; false: not enough bits */
bool null_rectangles(int n, struct rectangle *P, struct rectangle *v);
void scale_rectangles(int n, struct rectangle *v);          /* the largest becomes 1 */

/* ---- poles.c: roots with proof ---- */

struct pole {                       /* of the upper half plane or real; its conjugate is implied */
	struct rectangle at;        /* encloses the pole; a part that is 0 is exactly [0,0] */
	bool real, imaginary;
};
struct spectrum {                   /* the distinct poles of one denominator, 0 excepted */
	struct poly D;              /* primitive */
	int zero;                   /* multiplicity of the pole 0 */
	int factors;
	struct factor *factor;
	int *poles;                 /* per factor */
	struct pole **pole;
	int precision;              /* bits to which the poles are known now; 0: not yet */
	struct iteration *iteration; /* poles.c: where the iteration stands, per factor */
	struct growth *growth;      /* residues.c: e^{p tau} and the denominator's series at the poles */
	struct spectrum *next;
};
struct spectrum *spectrum_of(struct poly D);                /* the same object for the same D */
/* Of their product, primitive; what is known of its factors saves finding them, and roots of fewer at a time */
struct spectrum *spectrum_of_product(int count, const struct poly *part);
/* Where the roots are, roughly, 0 among them: for an iteration that has not begun */
void spectrum_expect(struct spectrum *spectrum, int count, const double *re, const double *im);
/* relative 2^-precision; false: not isolated within the limits */
bool spectrum_refine(struct spectrum *spectrum, int precision);

/* ---- residues.c: values of c e^{A tau} b as sums of residues, enclosed ---- */

struct response {                   /* scale * N/D, N and D coprime */
	mpq_t scale;
	struct poly N;
	struct spectrum *spectrum;
	mpq_t *at_zero;             /* residue at 0 as a polynomial in tau: zero-th coefficient first */
	struct rectangle ***residue; /* [factor][pole][k], for `precision` bits */
	int precision;
	mpq_t last;                 /* time at which it was enclosed last */
	mpq_srcptr a, w;            /* the pole a + i w is left out of the sum; NULL: none is */
	bool alone;                 /* then no pole but 0 is summed */
};
struct response *response_of(mpq_srcptr scale, struct poly N, struct poly D);
struct response *response_scaled(const struct response *response, mpq_srcptr factor);
/* The same less the residues at a +- i w, w >= 0, roots of `pole`, which a load alone has brought in */
struct response *response_without(const struct response *whole, struct poly pole, mpq_srcptr a, mpq_srcptr w);
/* True if the value at tau is rational: then `exact` is it. False: it is transcendental, and response_enclose
 * converges. */
bool response_exact(struct response *response, mpq_srcptr tau, mpq_ptr exact);
/* false: poles not isolated */
bool response_enclose(struct response *response, mpq_srcptr tau, int precision, mpfi_ptr value);

/* ---- taylor.c, polynomial.c: e^{A tau} as a whole, enclosed or exact ---- */

struct taylor;                      /* one rational A (n x n, row-major) and one tau */
struct taylor *taylor_of(int n, const mpq_t *A, mpq_srcptr tau);
struct taylor *taylor_doubled(struct taylor *half);         /* of the same A at twice the time: the square */
/* Every entry to an absolute error below 2^-precision times the largest entry's size (of the real e^{A tau} or its
 * enclosure); small entries of short paths come out to nearly that many bits of their own. Cached: asking for less than
 * is known costs nothing. False: |A tau| above 2^512, an entry beyond 2^(2^50), or errors that outgrow 64 kbit. */
bool taylor_enclose(struct taylor *t, int precision);
/* sets value's precision; after taylor_enclose */
void taylor_entry(const struct taylor *t, int i, int j, mpfi_ptr value);
/* True if the entry is a polynomial in tau, zero included, for every tau: then `exact` is its value at this one. */
bool taylor_exact(struct taylor *t, int i, int j, mpq_ptr exact);

/* ---- stream.c: x' = A x, x enclosed ---- */

enum { STREAM_HALVINGS = 40 };
struct stream {                       /* of one rational A (n x n) */
	int n, precision;
	int *first, *column;        /* entries that are not 0, row by row: */
	mpfi_t *entry;
	double *size;               /* |A|, rounded up, n x n */
	double *scale, rate;        /* D, powers of two; rate bounds the norm of D^-1 |A| D */
	int halvings;
	mpq_t piece;                /* h 2^-halvings: there rate times it is at most 1 */
	int powers;
	mpfi_t **power;             /* e^{A piece 2^k} */
};
struct series_room {                /* x(s tau) = sum of term[m] s^m */
	int terms;
	mpfi_t **term;
};
struct stream *stream_of(int n, const mpq_t *A, mpq_srcptr h, int precision);
void stream_free(struct stream *f);
/* The Taylor polynomial of x from these on, its remainder for 0 <= s <= 1.0001 in term[0]; returns its degree */
int  stream_expand(const struct stream *f, const mpfi_t *x, mpq_srcptr tau, struct series_room *room);
/* Of all x whose entries are at most width_i 2^unit from those `core` was expanded from, to that degree */
void stream_widen(const struct stream *f, const struct series_room *core, int degree, const double *width,
		  long unit, mpq_srcptr tau, struct series_room *room);
void stream_sum(const struct stream *f, const struct series_room *room, int degree, mpfr_srcptr s, mpfi_t *x);
/* From the equations `before` to those `after`, at a time within delta of now: x as `after` would have it now; NULL:
 * as it is then. False: that is too long to be known */
bool stream_change(const struct stream *before, const struct stream *after, mpfr_srcptr delta, mpfi_t *x);
bool stream_change_within(const struct stream *before, const struct stream *after, mpfi_srcptr time, mpfi_t *x);
double stream_rates(const struct stream *before, const struct stream *after); /* of both, by the scales of before */
void stream_slope(const struct stream *f, const mpfi_t *x, mpfi_t *slope);      /* A x */
void stream_pieces(struct stream *f, int power, const mpfi_t *x, mpfi_t *y);       /* y = e^{A piece 2^power} x */
void series_room_free(struct series_room *room);

/* ---- positive.c: where a sum of forcing terms of time stays at 0 or above ---- */

struct summand { mpq_srcptr factor, a, w, p; int power; bool sine; };   /* factor t^power e^{a t} cos or sin(w t + p) */
/* From `from`, at least 0, to `to`; NULL: for good. False: it does not, or that is not seen. What is below 0 by less
 * than 2^-80 of the sum of its factors counts as 0. */
bool sum_stays_positive(int summands, const struct summand *summand, mpq_srcptr from, mpq_srcptr to);

/* ---- rise.c: where an enclosed polynomial first rises through 0 ---- */

enum rise { RISE_NONE, RISE_AT, RISE_UNKNOWN };
/* On 0 <= s <= end, value(0) at most 0, or not known apart from it. RISE_AT: `at` encloses the root, where it rises
 * with a slope above 0; RISE_UNKNOWN: it comes closer to 0 than is known. */
enum rise first_rise(int degree, const mpfi_t *value, const mpfi_t *slope, mpfr_srcptr end, mpfi_ptr at);

/* ---- walk.c: x+ = A x in double, step by step, and how far that rounds ---- */

/* A <- D^-1 A D, D = diag(scale) powers of 2, so that rows and columns of A - I become alike in size: exact */
void balance_map(int n, double *A, double *scale);
double norm_of_rows(int n, const double *A);                /* the largest sum of sizes; infinite of NaN */
struct sparse {                     /* the entries of a matrix that are not 0, row by row */
	int rows, *start, *column;
	double *value;
};
struct sparse sparse_of(int rows, int columns, const double *A);
void sparse_free(const struct sparse *s);
void sparse_add(const struct sparse *s, const double *x, double *sum);     /* sum + A x */
struct spread {                     /* of A, over so many steps; both are bounds, n x n */
	int n;
	long steps;
	double *sum, *most;         /* over m < steps of |A^m|; the largest of each entry */
	double slack;               /* of what a walk in double finds, relative to the largest of its vector */
	bool known;                 /* that is small */
};
struct spread spread_of(int n, const double *A, long steps);
/* Sums over m < steps of |row A^m|, and the largest of each entry; `columns`: of |A^m row|. Not every power is walked
 * through where they die away. */
void reach_of_row(const struct spread *spread, const double *A, const double *row, bool columns, double *sum,
		  double *most);

#endif
