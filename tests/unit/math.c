/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The doors of the mathematics by identities: what is multiplied out is divided, factored, inverted or summed back,
 * exactly or within the enclosures; enclosures are held against values that MPFR has from closed forms. */
#include "draw.h"
#include "emit/text.h"

#include <string.h>

enum { CASES = 300, TRUE_BITS = 600 };

/* ---- polynomials ---- */

static struct poly draw_poly(int degree, long most)
{
    struct poly p = poly_new(degree + 1);
    for (int k = 0; k <= degree; k++)
        mpz_set_si(p.c[k], draw(5) ? draw_integer(most) : 0);
    if (degree >= 0 && mpz_sgn(p.c[degree]) == 0)
        mpz_set_ui(p.c[degree], 1 + draw(9));
    return p;
}

static struct poly linear_poly(long a, long b)          /* a s + b */
{
    struct poly p = poly_new(2);
    mpz_set_si(p.c[0], b);
    mpz_set_si(p.c[1], a);
    return p;
}

static struct poly one_poly(void)
{
    struct poly p = poly_new(1);
    mpz_set_ui(p.c[0], 1);
    return p;
}

static const char *text_of(struct poly p)
{
    const char *text = "0";
    for (int k = 0; k < p.length; k++)
        text = format("%s%s%s s^%d", k ? text : "", k ? " + " : "", mpz_get_str(NULL, 10, p.c[k]), k);
    return text;
}

static void assert_poly(const char *what, int n, struct poly found, struct poly expected)
{
    if (!poly_equal(found, expected))
        fail_msg("%s, case %d: found %s, expected %s, exactly", what, n, text_of(found), text_of(expected));
}

static void value_at(struct poly p, mpz_srcptr x, mpz_ptr value)
{
    mpz_t term;
    mpz_init(term);
    mpz_set_ui(value, 0);
    for (int k = 0; k < p.length; k++) {
        mpz_pow_ui(term, x, (unsigned long)k);
        mpz_addmul(value, term, p.c[k]);
    }
    mpz_clear(term);
}

static void assert_value(const char *what, int n, struct poly p, mpz_srcptr x, mpz_srcptr expected)
{
    mpz_t found;
    mpz_init(found);
    value_at(p, x, found);
    if (mpz_cmp(found, expected) != 0)
        fail_msg("%s, case %d, at %s: found %s, expected %s, exactly", what, n, mpz_get_str(NULL, 10, x),
            mpz_get_str(NULL, 10, found), mpz_get_str(NULL, 10, expected));
    mpz_clear(found);
}

static void poly_values(void **state)
{
    mpz_t x, u, v, w, shifted;
    mpz_inits(x, u, v, w, shifted, NULL);
    (void)state;
    for (int n = 0; n < CASES; n++) {
        struct poly a = draw_poly((int)draw(9) - 1, 1000), b = draw_poly((int)draw(9) - 1, 1000);
        int shift = (int)draw(4);
        mpz_set_si(x, draw_integer(30));
        value_at(a, x, u);
        value_at(b, x, v);
        mpz_add(w, u, v);
        assert_value("sum", n, poly_add(a, b), x, w);
        mpz_sub(w, u, v);
        assert_value("difference", n, poly_sub(a, b), x, w);
        mpz_mul(w, u, v);
        assert_value("product", n, poly_mul(a, b), x, w);
        mpz_mul(w, u, x);
        assert_value("multiple", n, poly_scale(a, x), x, w);
        mpz_pow_ui(w, x, (unsigned long)shift);
        mpz_mul(w, w, u);
        assert_value("shift", n, poly_shift(a, shift), x, w);
        assert_poly("shift and back", n, poly_shift(poly_shift(a, shift), -shift), a);
        mpz_neg(w, x);
        assert_value("mirror", n, poly_mirror(a), w, u);
        if (a.length > 0)
            assert_int_equal(poly_valuation(poly_shift(a, shift)), poly_valuation(a) + shift);
        assert_int_equal(poly_sub(a, a).length, 0);
        /* a(x + y) = sum of a^(k)(x)/k! y^k */
        mpz_set_si(v, draw_integer(30));
        mpz_set_ui(w, 0);
        for (int k = a.length; k >= 0; k--) {
            value_at(poly_hasse(a, k), x, u);
            mpz_mul(w, w, v);
            mpz_add(w, w, u);
        }
        mpz_add(shifted, x, v);
        assert_value("Taylor's sum", n, a, shifted, w);
        struct poly left = poly_mul(poly_derivative(a), b), right = poly_mul(a, poly_derivative(b));
        assert_poly("derivative of a product", n, poly_derivative(poly_mul(a, b)), poly_add(left, right));
    }
    mpz_clears(x, u, v, w, shifted, NULL);
}

static struct poly primitive_of(struct poly p)
{
    mpz_t content;
    mpz_init(content);
    p = poly_primitive(p, content);
    mpz_clear(content);
    return p;
}

static void poly_content_times_primitive(void **state)
{
    mpz_t content, common;
    mpz_inits(content, common, NULL);
    (void)state;
    for (int n = 0; n < CASES; n++) {
        struct poly a = draw_poly((int)draw(7), 50);
        mpz_set_si(content, draw_integer(60) * 2 + 1);
        a = poly_scale(a, content);
        struct poly p = poly_primitive(a, content);
        assert_poly("content times primitive part", n, poly_scale(p, content), a);
        mpz_set_ui(common, 0);
        for (int k = 0; k < p.length; k++)
            mpz_gcd(common, common, p.c[k]);
        if (mpz_cmp_ui(common, 1) != 0 || mpz_sgn(p.c[p.length - 1]) < 0)
            fail_msg("case %d: %s has content %s; expected 1, its leading coefficient positive", n, text_of(p),
                mpz_get_str(NULL, 10, common));
    }
    mpz_clears(content, common, NULL);
}

static void poly_product_divided(void **state)
{
    (void)state;
    for (int n = 0; n < CASES; n++) {
        struct poly a = draw_poly((int)draw(7), 1000), b = primitive_of(draw_poly(1 + (int)draw(6), 1000));
        struct poly ab = poly_mul(a, b), one = one_poly();
        assert_poly("a b / b", n, poly_divide(ab, b), a);
        if (!poly_divides(b, ab))
            fail_msg("case %d: %s does not divide %s, a multiple of it", n, text_of(b), text_of(ab));
        if (poly_divides(b, poly_add(ab, one)))
            fail_msg("case %d: %s divides a multiple of it plus 1", n, text_of(b));
    }
}

enum { FACTORS = 6 };

/* Primitive factors of degree 1 and 2 of which no two have a root in common, none 0: a s + b with different b/a; (c
 * s)^2 + w^2; some are the mirror image of the one before */
static int draw_factors(struct poly *factor, int most)
{
    int count = 0;
    for (int tries = 0; count < most && tries < 40; tries++) {
        struct poly g = linear_poly(1 + (long)draw(9), draw_integer(20));
        if (draw(4) == 0) {
            g = poly_new(3);
            mpz_set_ui(g.c[0], 1 + draw(30));
            mpz_set_si(g.c[1], draw(2) ? 0 : draw_integer(2));      /* b^2 < 4 a c: no real root */
            mpz_set_ui(g.c[2], 4);
            mpz_setbit(g.c[0], 0);
        } else if (count > 0 && draw(3) == 0) {
            g = poly_mirror(factor[count - 1]);
        }
        g = primitive_of(g);
        bool fresh = mpz_sgn(g.c[0]) != 0;
        for (int i = 0; i < count; i++)
            fresh = fresh && !poly_equal(g, factor[i]);
        if (fresh)
            factor[count++] = g;
    }
    return count;
}

static struct poly product_of(int count, const struct poly *factor, const int *power)
{
    struct poly product = one_poly();
    for (int i = 0; i < count; i++)
        for (int k = 0; k < power[i]; k++)
            product = poly_mul(product, factor[i]);
    return product;
}

/* The common part of two products is known: the lesser power of each factor. */
static void poly_common_divisor(void **state)
{
    mpz_t content;
    mpz_init(content);
    (void)state;
    for (int n = 0; n < CASES; n++) {
        struct poly factor[FACTORS];
        int count = draw_factors(factor, 1 + (int)draw(FACTORS)), a[FACTORS], b[FACTORS], least[FACTORS];
        for (int i = 0; i < count; i++) {
            a[i] = (int)draw(3);
            b[i] = (int)draw(3);
            least[i] = a[i] < b[i] ? a[i] : b[i];
        }
        mpz_set_si(content, draw_integer(99) * 2 + 1);
        struct poly u = poly_scale(product_of(count, factor, a), content), v = product_of(count, factor, b);
        struct poly g = poly_gcd(u, v);
        assert_poly("greatest common divisor", n, g, product_of(count, factor, least));
        assert_poly("with 0", n, poly_gcd(poly_new(0), u), primitive_of(u));
        assert_poly("with 0", n, poly_gcd(u, poly_new(0)), primitive_of(u));
    }
    mpz_clear(content);
}

/* Where the quick proof of coprimality, which is modulo 2^61 - 1, has nothing to say */
static void poly_common_divisor_beyond_the_screen(void **state)
{
    mpz_t prime;
    mpz_init_set_ui(prime, 2305843009213693951u);
    (void)state;
    for (int n = 0; n < 50; n++) {
        struct poly c = linear_poly(3, 1 + (long)draw(50) * 3), d = linear_poly(2, 1), shifted = poly_new(2);
        struct poly f = linear_poly(5, 2);
        mpz_set(shifted.c[0], prime);
        shifted = poly_add(shifted, d);         /* the same as d modulo the prime */
        assert_poly("coprime but for the prime", n, poly_gcd(poly_mul(d, c), shifted), one_poly());
        mpz_set(f.c[1], prime);                 /* modulo the prime a constant */
        assert_poly("leading coefficient 0 modulo the prime", n, poly_gcd(poly_mul(f, c), poly_mul(f, d)), f);
    }
    mpz_clear(prime);
}

static struct poly mirror_image(struct poly g)
{
    return primitive_of(poly_mirror(g));
}

static void check_factor(int n, const struct factor *f)
{
    struct poly g = f->g, one = one_poly();
    if (g.length < 2 || mpz_sgn(g.c[0]) == 0)
        fail_msg("case %d: factor %s; expected no constant and no root 0", n, text_of(g));
    assert_poly("a factor and its derivative", n, poly_gcd(g, poly_derivative(g)), one);
    if (f->symmetric)
        assert_poly("symmetric factor, mirrored", n, mirror_image(g), g);
    else
        assert_poly("a factor that is not symmetric and its mirror image", n, poly_gcd(g, mirror_image(g)), one);
}

static void poly_square_free_factors(void **state)
{
    (void)state;
    for (int n = 0; n < CASES; n++) {
        struct poly factor[FACTORS];
        int count = draw_factors(factor, 1 + (int)draw(FACTORS)), power[FACTORS];
        for (int i = 0; i < count; i++)
            power[i] = 1 + (int)draw(4);
        struct poly whole = product_of(count, factor, power), back = one_poly();
        struct factor *found;
        int founds = poly_square_free(poly_shift(whole, (int)draw(3)), &found);
        for (int k = 0; k < founds; k++) {
            check_factor(n, &found[k]);
            for (int m = 0; m < found[k].multiplicity; m++)
                back = poly_mul(back, found[k].g);
            for (int i = 0; i < count; i++)
                if (poly_divides(factor[i], found[k].g) && power[i] != found[k].multiplicity)
                    fail_msg("case %d: %s of multiplicity %d is found with multiplicity %d", n,
                        text_of(factor[i]), power[i], found[k].multiplicity);
        }
        assert_poly("product of square-free factors", n, primitive_of(back), whole);
    }
}

/* ---- matrices of polynomials ---- */

enum { ORDER = 6 };

static struct polymat draw_polymat(int n, uint32_t filled)
{
    struct polymat P = { n, ARRAY(struct poly, (size_t)(n * n)) };
    for (int i = 0; i < n * n; i++)
        P.cell[i] = draw(8) < filled ? draw_poly((int)draw(3), 20) : poly_new(0);
    return P;
}

/* By the first row and what is left without it and one column */
static struct poly expanded_determinant(struct polymat P)
{
    struct poly sum = poly_new(0);
    if (P.n == 0)
        return one_poly();
    struct polymat minor = { P.n - 1, ARRAY(struct poly, (size_t)(P.n * P.n)) };
    for (int j = 0; j < P.n; j++) {
        int at = 0;
        if (P.cell[j].length == 0)
            continue;
        for (int cell = P.n; cell < P.n * P.n; cell++)
            if (cell % P.n != j)
                minor.cell[at++] = P.cell[cell];
        struct poly term = poly_mul(P.cell[j], expanded_determinant(minor));
        sum = j % 2 ? poly_sub(sum, term) : poly_add(sum, term);
    }
    return sum;
}

static void polymat_times_adjugate(void **state)
{
    int regular = 0;
    (void)state;
    for (int n = 0; n < CASES; n++) {
        struct polymat P = draw_polymat(1 + (int)draw(5), 3 + draw(6)), adj = { P.n, ARRAY(struct poly, 25) };
        struct poly expected = expanded_determinant(P), det, alone;
        if (expected.length == 0)
            continue;
        regular++;
        polymat_adjugate(P, &det, &adj);
        assert_poly("determinant", n, det, expected);
        polymat_adjugate(P, &alone, NULL);
        assert_poly("determinant alone", n, alone, expected);
        for (int i = 0; i < P.n; i++)
            for (int j = 0; j < P.n; j++) {
                struct poly sum = poly_new(0);
                for (int k = 0; k < P.n; k++)
                    sum = poly_add(sum, poly_mul(P.cell[i * P.n + k], adj.cell[k * P.n + j]));
                assert_poly("P adj P", n, sum, i == j ? det : poly_new(0));
            }
    }
    assert_true(regular > CASES / 2);
}

/* Two to three blocks, some alike, with rows and columns exchanged */
static void polymat_blocks(void **state)
{
    int regular = 0;
    (void)state;
    for (int n = 0; n < CASES; n++) {
        int order = 0, row[ORDER], column[ORDER];
        struct polymat P = { ORDER, ARRAY(struct poly, ORDER * ORDER) }, block = draw_polymat(2, 7);
        for (int i = 0; i < ORDER; i++)
            row[i] = column[i] = i;
        for (int i = ORDER - 1; i > 0; i--) {
            int other[2] = { (int)draw((uint32_t)i + 1), (int)draw((uint32_t)i + 1) }, kept[2] = { row[i], column[i] };
            row[i] = row[other[0]];
            row[other[0]] = kept[0];
            column[i] = column[other[1]];
            column[other[1]] = kept[1];
        }
        while (order < ORDER) {
            if (draw(2))
                block = draw_polymat(1 + (int)draw(ORDER - (uint32_t)order > 3 ? 3 : ORDER - (uint32_t)order), 7);
            if (order + block.n > ORDER)
                continue;
            for (int cell = 0; cell < block.n * block.n; cell++) {
                int i = row[order + cell / block.n], j = column[order + cell % block.n];
                P.cell[i * ORDER + j] = block.cell[cell];
            }
            order += block.n;
        }
        struct poly expected = expanded_determinant(P), det;
        if (expected.length == 0)
            continue;
        regular++;
        polymat_adjugate(P, &det, NULL);
        assert_poly("determinant of blocks", n, det, expected);
    }
    assert_true(regular > CASES / 2);
}

/* ---- rational matrices ---- */

static mpq_t *draw_matrix(int rows, int columns)
{
    mpq_t *A = rationals((size_t)(rows * columns));
    for (int i = 0; i < rows * columns; i++)
        if (draw(4))
            draw_fraction(A[i], 50, 9);
    return A;
}

static void assert_rational(const char *what, int n, int i, int j, mpq_srcptr found, mpq_srcptr expected)
{
    if (!mpq_equal(found, expected))
        fail_msg("%s, case %d, (%d, %d): found %s, expected %s, exactly", what, n, i, j, mpq_get_str(NULL, 10, found),
            mpq_get_str(NULL, 10, expected));
}

/* Each entry by its sum */
static void assert_product(const char *what, int n, int rows, int inner, int columns, const mpq_t *A, const mpq_t *B,
                           const mpq_t *AB)
{
    mpq_t sum, term;
    mpq_inits(sum, term, NULL);
    for (int i = 0; i < rows; i++)
        for (int j = 0; j < columns; j++) {
            mpq_set_ui(sum, 0, 1);
            for (int k = 0; k < inner; k++) {
                mpq_mul(term, A[i * inner + k], B[k * columns + j]);
                mpq_add(sum, sum, term);
            }
            assert_rational(what, n, i, j, AB[i * columns + j], sum);
        }
    mpq_clears(sum, term, NULL);
}

static mpq_t *unit_matrix(int n)
{
    mpq_t *I = rationals((size_t)(n * n));
    for (int i = 0; i < n; i++)
        mpq_set_ui(I[i * n + i], 1, 1);
    return I;
}

static void matrix_products(void **state)
{
    mpq_t factor;
    mpq_init(factor);
    (void)state;
    for (int n = 0; n < CASES; n++) {
        int rows = 1 + (int)draw(5), inner = 1 + (int)draw(5), columns = 1 + (int)draw(5);
        mpq_t *A = draw_matrix(rows, inner), *B = draw_matrix(inner, columns), *AB = draw_matrix(rows, columns);
        rational_product(rows, inner, columns, (const mpq_t *)A, (const mpq_t *)B, AB);
        assert_product("product", n, rows, inner, columns, (const mpq_t *)A, (const mpq_t *)B, (const mpq_t *)AB);
        /* row 0 less factor times row 1, which back gives row 0 */
        mpq_t *pair = draw_matrix(2, columns), *row = rationals((size_t)columns);
        draw_fraction(factor, 30, 7);
        for (int j = 0; j < columns; j++)
            mpq_set(row[j], pair[j]);
        rational_subtract_row(columns, row, (const mpq_t *)pair + columns, factor);
        for (int j = 0; j < columns; j++) {
            mpq_mul(AB[0], pair[columns + j], factor);
            mpq_add(AB[0], AB[0], row[j]);
            assert_rational("row and what was taken from it", n, 0, j, AB[0], pair[j]);
        }
    }
    mpq_clear(factor);
}

static void matrix_inverse(void **state)
{
    int regular = 0;
    (void)state;
    for (int n = 0; n < CASES; n++) {
        int order = 1 + (int)draw(6), column;
        mpq_t *A = draw_matrix(order, order), *inverse = draw_matrix(order, order), *I = unit_matrix(order);
        if (!rational_inverse(order, (const mpq_t *)A, inverse, &column))
            continue;
        regular++;
        assert_product("A A^-1", n, order, order, order, (const mpq_t *)A, (const mpq_t *)inverse, (const mpq_t *)I);
        assert_product("A^-1 A", n, order, order, order, (const mpq_t *)inverse, (const mpq_t *)A, (const mpq_t *)I);
    }
    assert_true(regular > CASES / 2);
}

/* One column is a sum of those before, which are independent: those of a regular triangle with rows exchanged */
static void matrix_free_column(void **state)
{
    mpq_t factor, term;
    mpq_inits(factor, term, NULL);
    (void)state;
    for (int n = 0; n < CASES; n++) {
        int order = 1 + (int)draw(6), free_column = (int)draw((uint32_t)order), column = -1, turn = (int)draw(6);
        mpq_t *A = draw_matrix(order, order), *inverse = draw_matrix(order, order);
        for (int i = 0; i < order; i++)
            for (int j = 0; j <= i; j++)
                mpq_set_si(A[((i + turn) % order) * order + j], i == j ? 1 + (long)draw(9) : 0, 1);
        for (int i = 0; i < order; i++)
            mpq_set_ui(A[i * order + free_column], 0, 1);
        for (int j = 0; j < free_column; j++) {
            draw_fraction(factor, 9, 5);
            for (int i = 0; i < order; i++) {
                mpq_mul(term, factor, A[i * order + j]);
                mpq_add(A[i * order + free_column], A[i * order + free_column], term);
            }
        }
        if (rational_inverse(order, (const mpq_t *)A, inverse, &column) || column != free_column)
            fail_msg("case %d, order %d: free column found %d, expected %d", n, order, column, free_column);
    }
    mpq_clears(factor, term, NULL);
}

/* ---- systems: M q'' + C q' + K q = -heldC q' - heldK q holds for what the state's derivatives are ---- */

static struct linear draw_system(void)
{
    int n = 1 + (int)draw(4), column;
    struct linear shape = {
        .n = n, .states = n, .segments = 1, .velocity = ARRAY(int, (size_t)n), .coord = ARRAY(int, 8)
    };
    for (int i = 0; i < n; i++)
        shape.coord[i] = i;
    for (int i = 0; i < n; i++) {
        shape.velocity[i] = draw(3) ? shape.states : -1;
        if (shape.velocity[i] >= 0)
            shape.coord[shape.states++] = i;
    }
    struct linear s = linear_like(&shape);
    mpq_t *inverse = rationals((size_t)(n * n));
    do {
        s.C = draw_matrix(n, n);
        s.K = draw_matrix(n, n);
        s.M = draw_matrix(n, n);
        for (int i = 0; i < n * n; i++)
            if (s.velocity[i % n] < 0)
                mpq_set_ui(s.M[i], 0, 1);
    } while (!leading_inverse(&s, inverse, &column));
    s.heldC = draw_matrix(n, n);
    s.heldK = draw_matrix(n, n);
    for (int i = 0; i < n * n; i++)
        if (s.velocity[i % n] < 0)
            mpq_set_ui(s.heldC[i], 0, 1);   /* a held derivative of first order is none of the states */
    return s;
}

static void add_product(mpq_ptr sum, mpq_srcptr a, mpq_srcptr b)
{
    mpq_t term;
    mpq_init(term);
    mpq_mul(term, a, b);
    mpq_add(sum, sum, term);
    mpq_clear(term);
}

/* Row i of what the equations leave at y with its slope */
static void residual_of(const struct linear *s, int i, const mpq_t *y, const mpq_t *slope, bool held, mpq_ptr sum)
{
    mpq_set_ui(sum, 0, 1);
    for (int j = 0; j < s->n; j++) {
        int v = s->velocity[j], at = i * s->n + j;
        add_product(sum, v >= 0 ? s->M[at] : s->C[at], slope[v >= 0 ? v : j]);
        add_product(sum, held ? s->heldK[at] : s->K[at], y[j]);
        if (v >= 0)
            add_product(sum, held ? s->heldC[at] : s->C[at], y[v]);
    }
}

static void matrix_of_a_state(void **state)
{
    mpq_t sum, zero;
    mpq_inits(sum, zero, NULL);
    (void)state;
    for (int n = 0; n < CASES; n++) {
        struct linear s = draw_system();
        mpq_t *y = draw_matrix(s.states, 1), *slope = rationals((size_t)s.states);
        for (int held = 0; held < 2; held++) {
            mpq_t *A = state_matrix(&s, held);
            rational_product(s.states, s.states, 1, (const mpq_t *)A, (const mpq_t *)y, slope);
            for (int i = 0; i < s.n; i++) {
                residual_of(&s, i, (const mpq_t *)y, (const mpq_t *)slope, held, sum);
                assert_rational(held ? "held terms" : "equations", n, i, 0, sum, zero);
                if (s.velocity[i] >= 0)
                    assert_rational("q' is v", n, i, 0, slope[i], held ? zero : y[s.velocity[i]]);
            }
        }
        mpq_t *A = draw_matrix(s.n, s.n), *I = unit_matrix(s.n);
        struct linear first = first_order_system(s.n, (const mpq_t *)A);
        assert_product("x' = A x", n, s.n, s.n, s.n, (const mpq_t *)A, (const mpq_t *)I,
                       (const mpq_t *)state_matrix(&first, false));
    }
    mpq_clears(sum, zero, NULL);
}

/* ---- enclosures ---- */

static void assert_interval(const char *what, int n, mpfi_srcptr found, mpfr_srcptr truth)
{
    mpfr_t slack, low, high;                /* the truth is off by some 2^-TRUE_BITS of its terms */
    mpfr_inits2(TRUE_BITS, slack, low, high, NULL);
    mpfr_set_ui_2exp(slack, 1, -TRUE_BITS / 2, MPFR_RNDN);
    mpfr_sub(low, &found->left, slack, MPFR_RNDD);
    mpfr_add(high, &found->right, slack, MPFR_RNDU);
    if (!(mpfr_cmp(low, truth) <= 0 && mpfr_cmp(high, truth) >= 0) || mpfr_nan_p(low) || mpfr_nan_p(high))
        fail_msg("%s, case %d: the truth %.17g is not in [%.17g, %.17g]", what, n, mpfr_get_d(truth, MPFR_RNDN),
            mpfr_get_d(&found->left, MPFR_RNDD), mpfr_get_d(&found->right, MPFR_RNDU));
    mpfr_clears(slack, low, high, NULL);
}

/* Its width, below 2^bits */
static void assert_narrow(const char *what, int n, mpfi_srcptr found, long bits)
{
    mpfr_t width, most;
    mpfr_inits2(64, width, most, NULL);
    mpfi_diam_abs(width, found);
    mpfr_set_ui_2exp(most, 1, bits, MPFR_RNDN);
    if (!mpfr_lessequal_p(width, most))
        fail_msg("%s, case %d: [%.17g, %.17g] is %.3g wide; expected at most 2^%ld", what, n,
                 mpfr_get_d(&found->left, MPFR_RNDD), mpfr_get_d(&found->right, MPFR_RNDU),
                 mpfr_get_d(width, MPFR_RNDU), bits);
    mpfr_clears(width, most, NULL);
}

/* What all rows annihilate, and as many of them as there are: rank and nullity add up. */
static void echelon_against_its_rows(void **state)
{
    mpq_t sum, product;
    mpq_inits(sum, product, NULL);
    (void)state;
    for (int n = 0; n < CASES; n++) {
        const int width = 1 + (int)draw(6), rows = (int)draw(8);
        struct echelon e = echelon_new(width);
        mpq_t *A = draw_matrix(8, width), **basis;
        for (int i = 1; i < rows; i++)          /* some are sums of those before them */
            for (int j = 0; j < width && draw(3) == 0; j++)
                mpq_set(A[i * width + j], A[(i - 1) * width + j]);
        for (int i = 0; i < rows; i++) {
            mpq_t *row = rationals((size_t)width);
            for (int j = 0; j < width; j++)
                mpq_set(row[j], A[i * width + j]);
            echelon_add(&e, row);
        }
        const int count = echelon_null_space(&e, &basis);
        if (count + e.rank != width)
            fail_msg("case %d: nullity %d and rank %d of width %d", n, count, e.rank, width);
        for (int i = 0; i < rows; i++)
            for (int k = 0; k < count; k++) {
                mpq_set_ui(sum, 0, 1);
                for (int j = 0; j < width; j++) {
                    mpq_mul(product, A[i * width + j], basis[k][j]);
                    mpq_add(sum, sum, product);
                }
                if (mpq_sgn(sum) != 0)
                    fail_msg("case %d: row %d times vector %d is %g, not 0", n, i, k, mpq_get_d(sum));
            }
        for (int k = 0; k < count; k++) {       /* independent: each has a 1 where the others have 0 */
            int own = 0;
            for (int j = 0; j < width; j++) {
                bool only = mpq_cmp_ui(basis[k][j], 1, 1) == 0;
                for (int other = 0; other < count; other++)
                    only = only && (other == k || mpq_sgn(basis[other][j]) == 0);
                own += only;
            }
            if (own == 0)
                fail_msg("case %d: vector %d may depend on the others", n, k);
        }
    }
    mpq_clears(sum, product, NULL);
}

/* P = A with its last row a sum of the others, complex: P v encloses 0, narrowly, and v is not 0. */
static void null_rectangles_of_sums(void **state)
{
    mpq_t re;
    mpq_init(re);
    (void)state;
    for (int n = 0; n < CASES / 4; n++) {
        const int order = 2 + (int)draw(4), cells = order * order, bits = 200;
        struct rectangle *P = rectangles(cells, bits), *kept = rectangles(cells, bits), sum;
        struct rectangle *v = rectangles(order, bits);
        for (int i = 0; i < cells - order; i++) {
            draw_fraction(re, 9, 5);
            mpfi_set_q(P[i].re, re);
            draw_fraction(re, 9, 5);
            mpfi_set_q(P[i].im, re);
        }
        for (int i = 0; i < cells - order; i++) {
            struct rectangle *last = &P[cells - order + i % order];
            mpfi_add(last->re, last->re, P[i].re);
            mpfi_add(last->im, last->im, P[i].im);
        }
        for (int i = 0; i < cells; i++)
            rectangle_set(&kept[i], &P[i]);
        if (!null_rectangles(order, P, v))
            fail_msg("case %d: no null vector of a matrix of rank %d with %d bits", n, order - 1, bits);
        scale_rectangles(order, v);
        rectangle_init(&sum, bits);
        for (int i = 0; i < order; i++) {
            mpfi_set_ui(sum.re, 0);
            mpfi_set_ui(sum.im, 0);
            for (int j = 0; j < order; j++)
                rectangle_add_product(&sum, &kept[i * order + j], &v[j]);
            if (!mpfi_has_zero(sum.re) || !mpfi_has_zero(sum.im) || rectangle_size(&sum) > -100)
                fail_msg("case %d: row %d of P v has size 2^%ld, and may not be 0", n, i, rectangle_size(&sum));
        }
        rectangle_clear(&sum);
        clear_rectangles(&P);
        clear_rectangles(&kept);
        clear_rectangles(&v);
    }
    mpq_clear(re);
}

/* e^{(a + i b) tau} against MPFR, and times e^{-(a + i b) tau} against 1 */
static void rectangle_exponential(void **state)
{
    mpq_t a, b, tau;
    mpfr_t size, re, im, one, zero;
    mpq_inits(a, b, tau, NULL);
    mpfr_inits2(TRUE_BITS, size, re, im, one, zero, NULL);
    mpfr_set_ui(one, 1, MPFR_RNDN);
    mpfr_set_zero(zero, 1);
    (void)state;
    for (int n = 0; n < CASES; n++) {
        struct rectangle p, minus, z, back;
        int bits = 24 + (int)draw(200);
        rectangle_init(&p, bits);
        rectangle_init(&minus, bits);
        rectangle_init(&z, bits);
        rectangle_init(&back, bits);
        draw_fraction(a, 20, 7);
        draw_fraction(b, 60, 7);
        draw_fraction(tau, 8, 9);
        mpfi_set_q(p.re, a);
        mpfi_set_q(p.im, b);
        rectangle_exp(&z, &p, tau);
        mpq_mul(a, a, tau);
        mpq_mul(b, b, tau);
        mpfr_set_q(size, a, MPFR_RNDN);
        mpfr_exp(size, size, MPFR_RNDN);
        mpfr_set_q(re, b, MPFR_RNDN);
        mpfr_sin_cos(im, re, re, MPFR_RNDN);
        mpfr_mul(re, re, size, MPFR_RNDN);
        mpfr_mul(im, im, size, MPFR_RNDN);
        assert_interval("real part", n, z.re, re);
        assert_interval("imaginary part", n, z.im, im);
        long wide = mpfr_get_exp(size) + 12 - bits;     /* |p tau| is below 2^9 */
        assert_narrow("real part", n, z.re, wide);
        assert_narrow("imaginary part", n, z.im, wide);
        rectangle_sub(&minus, &minus, &p);
        rectangle_exp(&back, &minus, tau);
        rectangle_mul(&z, &z, &back);
        assert_interval("e^p e^-p", n, z.re, one);
        assert_interval("e^p e^-p", n, z.im, zero);
        rectangle_clear(&p);
        rectangle_clear(&minus);
        rectangle_clear(&z);
        rectangle_clear(&back);
    }
    mpq_clears(a, b, tau, NULL);
    mpfr_clears(size, re, im, one, zero, NULL);
}

/* c <- c (s - p), of `degree` before */
static void times_root(struct rectangle *c, int degree, const struct rectangle *p)
{
    struct rectangle term;
    rectangle_init(&term, (int)mpfi_get_prec(p->re));
    rectangle_set(&c[degree + 1], &c[degree]);
    for (int k = degree; k >= 0; k--) {
        rectangle_mul(&term, &c[k], p);
        if (k > 0)
            rectangle_sub(&c[k], &c[k - 1], &term);
        else
            rectangle_sub(&c[0], &c[degree + 2], &term);    /* 0 */
    }
    rectangle_clear(&term);
}

/* Roots that nobody knows, multiplied back with their multiplicities: the polynomial is in the enclosure. */
static void roots_multiplied_back(void **state)
{
    enum { MOST = 40, PRECISION = 256 };
    mpfr_t truth, zero;
    mpfr_inits2(TRUE_BITS, truth, zero, NULL);
    mpfr_set_zero(zero, 1);
    (void)state;
    for (int n = 0; n < 100; n++) {
        struct rectangle c[MOST], conjugate;
        struct poly D = draw_poly(1 + (int)draw(6), 100);
        if (draw(3) == 0)
            D = poly_mul(D, poly_mul(D, draw_poly((int)draw(4), 20)));
        D = poly_shift(primitive_of(D), (int)draw(3));
        struct spectrum *s = spectrum_of(D);
        int degree = s->zero;
        assert_true(spectrum_refine(s, PRECISION));
        for (int k = 0; k < MOST; k++)
            rectangle_init(&c[k], 2 * PRECISION);
        rectangle_init(&conjugate, 2 * PRECISION);
        mpfi_set_z(c[degree].re, D.c[D.length - 1]);
        for (int f = 0; f < s->factors; f++)
            for (int i = 0; i < s->poles[f] * s->factor[f].multiplicity; i++) {
                const struct pole *p = &s->pole[f][i % s->poles[f]];
                times_root(c, degree++, &p->at);
                if (p->real)
                    continue;
                rectangle_set(&conjugate, &p->at);
                mpfi_neg(conjugate.im, conjugate.im);
                times_root(c, degree++, &conjugate);
            }
        if (degree != D.length - 1)
            fail_msg("case %d: %d roots of %s; expected %d", n, degree, text_of(D), D.length - 1);
        for (int k = 0; k <= degree; k++) {
            mpfr_set_z(truth, D.c[k], MPFR_RNDN);
            assert_interval("roots multiplied back", n, c[k].re, truth);
            assert_interval("roots multiplied back, imaginary part", n, c[k].im, zero);
            assert_narrow("roots multiplied back", n, c[k].re, -PRECISION / 2);
        }
        for (int k = 0; k < MOST; k++)
            rectangle_clear(&c[k]);
        rectangle_clear(&conjugate);
    }
    mpfr_clears(truth, zero, NULL);
}

/* ---- residues ---- */

/* e^{a t} ((cosine + linear t) cos(w t) + sine sin(w t)), the terms of 1/((s - a)^2 + w^2)^2 and s/(...)^2 */
static void add_wave(mpfr_ptr sum, mpq_srcptr a, mpq_srcptr w, mpq_srcptr t, mpq_srcptr factor, int power, bool sine)
{
    mpfr_t x, angle;
    mpfr_inits2(TRUE_BITS, x, angle, NULL);
    mpfr_set_q(x, a, MPFR_RNDN);
    mpfr_mul_q(x, x, t, MPFR_RNDN);
    mpfr_exp(x, x, MPFR_RNDN);
    mpfr_set_q(angle, w, MPFR_RNDN);
    mpfr_mul_q(angle, angle, t, MPFR_RNDN);
    (sine ? mpfr_sin : mpfr_cos)(angle, angle, MPFR_RNDN);
    mpfr_mul(x, x, angle, MPFR_RNDN);
    mpfr_mul_q(x, x, factor, MPFR_RNDN);
    for (int k = 0; k < power; k++)
        mpfr_mul_q(x, x, t, MPFR_RNDN);
    mpfr_add(sum, sum, x, MPFR_RNDN);
    mpfr_clears(x, angle, NULL);
}

/* Poles of multiplicity 2 off the real axis, by the tables: with S = s - a,
 * 1/(S^2 + w^2)^2 is e^{a t} (sin(w t) - w t cos(w t))/(2 w^3), S/(S^2 + w^2)^2 is e^{a t} t sin(w t)/(2 w). */
static void residues_of_double_pairs(void **state)
{
    mpq_t a, w, t, scale, factor, exact;
    mpfr_t truth;
    mpfi_t value;
    mpq_inits(a, w, t, scale, factor, exact, NULL);
    mpfr_init2(truth, TRUE_BITS);
    (void)state;
    for (int n = 0; n < 100; n++) {
        bool linear = draw(2);
        long whole = draw_integer(9), turns = 1 + (long)draw(20);
        struct poly g = poly_new(3), N = linear ? linear_poly(1, -whole) : one_poly();
        mpz_set_si(g.c[0], whole * whole + turns * turns);
        mpz_set_si(g.c[1], -2 * whole);
        mpz_set_ui(g.c[2], 1);
        mpq_set_si(a, whole, 1);
        mpq_set_si(w, turns, 1);
        draw_fraction(scale, 50, 9);
        mpq_set_ui(t, 1 + draw(20), 1 + draw(20));
        mpq_canonicalize(t);
        mpfr_set_zero(truth, 1);
        mpq_set_si(factor, 1, linear ? (unsigned long)(2 * turns) : (unsigned long)(2 * turns * turns * turns));
        mpq_mul(factor, factor, scale);
        add_wave(truth, a, w, t, factor, linear, true);
        mpq_mul(factor, factor, w);
        mpq_neg(factor, factor);
        if (!linear)
            add_wave(truth, a, w, t, factor, 1, false);
        struct response *response = response_of(scale, N, poly_mul(g, g));
        if (response_exact(response, t, exact)) {
            assert_int_equal(mpq_sgn(scale), 0);
            continue;
        }
        int precision = 20 + (int)draw(150);
        mpfi_init2(value, 64 + precision);
        assert_true(response_enclose(response, t, precision, value));
        assert_interval("double pair", n, value, truth);
        mpfi_clear(value);
    }
    mpq_clears(a, w, t, scale, factor, exact, NULL);
    mpfr_clear(truth);
}

/* c/((s - a)(s - b)) is c (e^{a t} - e^{b t})/(a - b) */
static void residues_of_real_poles(void **state)
{
    mpq_t a, b, t, scale, factor, none;
    mpfr_t truth;
    mpfi_t value;
    (void)state;
    mpq_inits(a, b, t, scale, factor, none, NULL);
    mpfr_init2(truth, TRUE_BITS);
    for (int n = 0; n < 60; n++) {
        long first = draw_integer(9), second = first + 1 + (long)draw(9);
        mpq_set_si(a, first, 1);
        mpq_set_si(b, second, 1);
        draw_fraction(scale, 50, 9);
        mpq_set_ui(t, 1 + draw(20), 1 + draw(20));
        mpq_canonicalize(t);
        mpfr_set_zero(truth, 1);
        mpq_sub(factor, a, b);
        mpq_div(factor, scale, factor);
        add_wave(truth, a, none, t, factor, 0, false);
        mpq_neg(factor, factor);
        add_wave(truth, b, none, t, factor, 0, false);
        struct poly D = poly_mul(linear_poly(1, -first), linear_poly(1, -second));
        int precision = 20 + (int)draw(150);
        mpfi_init2(value, 64 + precision);
        assert_true(response_enclose(response_of(scale, one_poly(), D), t, precision, value));
        assert_interval("real poles", n, value, truth);
        mpfi_clear(value);
    }
    mpq_clears(a, b, t, scale, factor, none, NULL);
    mpfr_clear(truth);
}

/* sin(r t)/r with r^2 = 2, of one response that is asked again and again: at other times, with more bits or fewer. What
 * was found for one question is not good enough, or wrong, for the next. */
static void a_response_asked_anew(void **state)
{
    mpq_t t, one;
    mpfr_t root, truth;
    mpfi_t value;
    (void)state;
    mpq_inits(t, one, NULL);
    mpfr_inits2(TRUE_BITS, root, truth, NULL);
    mpq_set_ui(one, 1, 1);
    mpfr_sqrt_ui(root, 2, MPFR_RNDN);
    struct poly D = poly_new(3);
    mpz_set_ui(D.c[0], 2);
    mpz_set_ui(D.c[2], 1);
    struct response *response = response_of(one, one_poly(), D);
    for (int n = 0; n < 60; n++) {
        int precision = 20 + (int)draw(200);
        mpq_set_ui(t, 1 + draw(20), 1 + draw(20));
        mpq_canonicalize(t);
        mpfr_mul_q(truth, root, t, MPFR_RNDN);
        mpfr_sin(truth, truth, MPFR_RNDN);
        mpfr_div(truth, truth, root, MPFR_RNDN);
        mpfi_init2(value, 64 + precision);
        assert_true(response_enclose(response, t, precision, value));
        assert_interval("asked anew", n, value, truth);
        assert_narrow("asked anew", n, value, 16 - precision);  /* the phase r t is below 2^5 */
        mpfi_clear(value);
    }
    mpq_clears(t, one, NULL);
    mpfr_clears(root, truth, NULL);
}

/* c/s^m is c t^{m-1}/(m-1)!, which is a rational number */
static void residues_of_powers_of_time(void **state)
{
    mpq_t scale, t, truth, found;
    (void)state;
    mpq_inits(scale, t, truth, found, NULL);
    for (int n = 0; n < 60; n++) {
        int m = 1 + (int)draw(6);
        draw_fraction(scale, 50, 9);
        mpq_set_ui(t, 1 + draw(20), 1 + draw(20));
        mpq_canonicalize(t);
        mpq_set(truth, scale);
        for (int k = 1; k < m; k++) {
            mpq_set_ui(found, 1, (unsigned long)k);
            mpq_mul(truth, truth, found);
            mpq_mul(truth, truth, t);
        }
        struct response *response = response_of(scale, one_poly(), poly_shift(one_poly(), m));
        assert_true(response_exact(response, t, found));
        if (!mpq_equal(found, truth))
            fail_msg("case %d: s^-%d at %g: %.17g, expected %.17g", n, m, mpq_get_d(t), mpq_get_d(found),
                     mpq_get_d(truth));
    }
    mpq_clears(scale, t, truth, found, NULL);
}

/* At equal distances, two of one denominator in turn, each from its own start: e^{a t} sin(w t) */
static void responses_along_a_course(void **state)
{
    enum { ROWS = 90 };
    mpq_t a, w, t, scale, shift, one;
    mpfr_t truth;
    mpfi_t value;
    (void)state;
    mpq_inits(a, w, t, scale, shift, one, NULL);
    mpfr_init2(truth, TRUE_BITS);
    mpq_set_ui(shift, 1, 3);
    mpq_set_ui(one, 1, 1);
    for (int n = 0; n < 8; n++) {
        long i = (long)draw(20), j = 1 + (long)draw(40), rows = 1 + (long)draw(20);
        struct poly D = poly_new(3);            /* 64 ((s + i/8)^2 + (j/4)^2) */
        mpz_set_si(D.c[0], i * i + 4 * j * j);
        mpz_set_si(D.c[1], 16 * i);
        mpz_set_si(D.c[2], 64);
        mpq_set_si(a, -i, 8);
        mpq_set_si(w, j, 4);
        mpq_set_si(scale, 16 * j, 1);
        mpq_canonicalize(a);
        mpq_canonicalize(w);
        struct response *response[] = { response_of(scale, one_poly(), D), response_of(scale, one_poly(), D) };
        for (int k = 0; k < ROWS; k++)
            for (int r = 0; r < 2; r++) {
                mpq_set_si(t, k + (k > ROWS / 2 ? 1 : 0), (unsigned long)rows);         /* one stride is longer */
                mpq_canonicalize(t);
                if (r)
                    mpq_add(t, t, shift);
                mpfr_set_zero(truth, 1);
                add_wave(truth, a, w, t, one, 0, true);
                mpfi_init2(value, 200);
                assert_true(response_enclose(response[r], t, 128, value));
                assert_interval("along a course", n, value, truth);
                assert_narrow("along a course", n, value, -90);
                mpfi_clear(value);
            }
    }
    mpq_clears(a, w, t, scale, shift, one, NULL);
    mpfr_clear(truth);
}

/* ---- exponentials of matrices ---- */

enum { PRECISION = 120 };

static mpfi_t *entries_of(struct taylor *t, int n, int precision)
{
    mpfi_t *E = ARRAY(mpfi_t, (size_t)(n * n));
    assert_true(taylor_enclose(t, precision));
    for (int i = 0; i < n * n; i++) {
        mpfi_init(E[i]);
        taylor_entry(t, i / n, i % n, E[i]);
    }
    return E;
}

static void entries_free(int n, mpfi_t *E)
{
    for (int i = 0; i < n * n; i++)
        mpfi_clear(E[i]);
}

static mpfi_t *entries_product(int n, const mpfi_t *X, const mpfi_t *Y)
{
    mpfi_t *Z = ARRAY(mpfi_t, (size_t)(n * n)), term;
    mpfi_init2(term, TRUE_BITS);
    for (int i = 0; i < n * n; i++) {
        mpfi_init2(Z[i], TRUE_BITS);
        mpfi_set_ui(Z[i], 0);
        for (int k = 0; k < n; k++) {
            mpfi_mul(term, X[i / n * n + k], Y[k * n + i % n]);
            mpfi_add(Z[i], Z[i], term);
        }
    }
    mpfi_clear(term);
    return Z;
}

/* Two enclosures of one number meet, and each is narrow. */
static void assert_meet(const char *what, int n, int order, const mpfi_t *X, const mpfi_t *Y, long bits)
{
    for (int i = 0; i < order * order; i++) {
        if (mpfr_cmp(&X[i]->left, &Y[i]->right) > 0 || mpfr_cmp(&Y[i]->left, &X[i]->right) > 0)
            fail_msg("%s, case %d, entry (%d, %d): [%.17g, %.17g] and [%.17g, %.17g] do not meet", what, n, i / order,
                     i % order, mpfr_get_d(&X[i]->left, MPFR_RNDD), mpfr_get_d(&X[i]->right, MPFR_RNDU),
                     mpfr_get_d(&Y[i]->left, MPFR_RNDD), mpfr_get_d(&Y[i]->right, MPFR_RNDU));
        assert_narrow(what, n, X[i], bits);
        assert_narrow(what, n, Y[i], bits);
    }
}

/* |A tau| is a few at the most: no entry is beyond 2^ROOM */
enum { ROOM = 60 };

static mpq_t *draw_slow_matrix(int n)
{
    mpq_t *A = rationals((size_t)(n * n));
    for (int i = 0; i < n * n; i++)
        if (draw(3))
            draw_fraction(A[i], 6, 5);
    return A;
}

static void taylor_times_its_inverse(void **state)
{
    mpq_t tau;
    mpq_init(tau);
    (void)state;
    for (int n = 0; n < 60; n++) {
        int order = 1 + (int)draw(5);
        mpq_t *A = draw_slow_matrix(order), *minus = rationals((size_t)(order * order));
        mpfi_t *I = ARRAY(mpfi_t, (size_t)(order * order));
        for (int i = 0; i < order * order; i++) {
            mpq_neg(minus[i], A[i]);
            mpfi_init2(I[i], 64);
            mpfi_set_ui(I[i], i / order == i % order);
        }
        mpq_set_ui(tau, 1 + draw(12), 8);
        mpq_canonicalize(tau);
        mpfi_t *E = entries_of(taylor_of(order, (const mpq_t *)A, tau), order, PRECISION);
        mpfi_t *back = entries_of(taylor_of(order, (const mpq_t *)minus, tau), order, PRECISION);
        mpfi_t *product = entries_product(order, (const mpfi_t *)E, (const mpfi_t *)back);
        assert_meet("e^A e^-A", n, order, (const mpfi_t *)product, (const mpfi_t *)I, ROOM - PRECISION);
        entries_free(order, E);
        entries_free(order, back);
        entries_free(order, product);
        entries_free(order, I);
    }
    mpq_clear(tau);
}

static void taylor_doubled_twice(void **state)
{
    mpq_t tau, exact, other;
    mpq_inits(tau, exact, other, NULL);
    (void)state;
    for (int n = 0; n < 60; n++) {
        int order = 1 + (int)draw(6);
        mpq_t *A = draw_slow_matrix(order);
        mpq_set_ui(tau, 1 + draw(12), 32);
        mpq_canonicalize(tau);
        struct taylor *twice = taylor_doubled(taylor_of(order, (const mpq_t *)A, tau)), *again = taylor_doubled(twice);
        mpq_mul_2exp(tau, tau, 2);
        struct taylor *direct = taylor_of(order, (const mpq_t *)A, tau);
        mpfi_t *E = entries_of(again, order, PRECISION), *D = entries_of(direct, order, PRECISION);
        assert_meet("doubled twice", n, order, (const mpfi_t *)E, (const mpfi_t *)D, ROOM - PRECISION);
        for (int i = 0; i < order * order; i++) {
            bool known = taylor_exact(again, i / order, i % order, exact);
            if (known != taylor_exact(direct, i / order, i % order, other) || (known && !mpq_equal(exact, other)))
                fail_msg("case %d, entry %d: exact as doubled %d, %g; directly %g", n, i, known, mpq_get_d(exact),
                         mpq_get_d(other));
        }
        entries_free(order, E);
        entries_free(order, D);
    }
    mpq_clears(tau, exact, other, NULL);
}

/* e^{A(s+t)} = e^{As} e^{At}, and e^{A+B} = e^A e^B for B = x + y A + z A^2 */
static void taylor_of_sums(void **state)
{
    mpq_t s, t, one, factor[3];
    mpq_inits(s, t, one, factor[0], factor[1], factor[2], NULL);
    mpq_set_ui(one, 1, 1);
    (void)state;
    for (int n = 0; n < 60; n++) {
        int order = 1 + (int)draw(5);
        mpq_t *A = draw_slow_matrix(order), *B = rationals((size_t)(order * order)),
              *sum = rationals((size_t)(order * order));
        mpq_set_ui(s, 1 + draw(8), 8);
        mpq_set_ui(t, 1 + draw(8), 16);
        mpq_canonicalize(s);
        mpq_canonicalize(t);
        mpfi_t *first = entries_of(taylor_of(order, (const mpq_t *)A, s), order, PRECISION);
        mpfi_t *second = entries_of(taylor_of(order, (const mpq_t *)A, t), order, PRECISION);
        mpfi_t *product = entries_product(order, (const mpfi_t *)first, (const mpfi_t *)second);
        mpq_add(s, s, t);
        mpfi_t *both = entries_of(taylor_of(order, (const mpq_t *)A, s), order, PRECISION);
        assert_meet("e^{A(s+t)}", n, order, (const mpfi_t *)product, (const mpfi_t *)both, ROOM - PRECISION);
        entries_free(order, first);
        entries_free(order, second);
        entries_free(order, product);
        entries_free(order, both);
        for (int k = 0; k < 3; k++)
            draw_fraction(factor[k], 3, 16);
        rational_product(order, order, order, (const mpq_t *)A, (const mpq_t *)A, sum);
        for (int i = 0; i < order * order; i++) {
            mpq_mul(B[i], sum[i], factor[2]);
            add_product(B[i], A[i], factor[1]);
            if (i / order == i % order)
                mpq_add(B[i], B[i], factor[0]);
            mpq_add(sum[i], A[i], B[i]);
        }
        first = entries_of(taylor_of(order, (const mpq_t *)A, one), order, 2 * PRECISION);
        second = entries_of(taylor_of(order, (const mpq_t *)B, one), order, 2 * PRECISION);
        both = entries_of(taylor_of(order, (const mpq_t *)sum, one), order, 2 * PRECISION);
        product = entries_product(order, (const mpfi_t *)first, (const mpfi_t *)second);
        assert_meet("e^{A+B}", n, order, (const mpfi_t *)product, (const mpfi_t *)both, 3 * ROOM - 2 * PRECISION);
        entries_free(order, first);
        entries_free(order, second);
        entries_free(order, product);
        entries_free(order, both);
    }
    mpq_clears(s, t, one, factor[0], factor[1], factor[2], NULL);
}

/* A = V diag(d) V^-1: e^{A tau} = V diag(e^{d tau}) V^-1, each exponential by MPFR; and as narrow as promised */
static void taylor_of_known_eigenvalues(void **state)
{
    mpfr_t e[5], sum, term, largest;
    mpq_t tau, factor;
    mpq_inits(tau, factor, NULL);
    mpfr_inits2(TRUE_BITS, sum, term, largest, NULL);
    for (int k = 0; k < 5; k++)
        mpfr_init2(e[k], TRUE_BITS);
    (void)state;
    for (int n = 0; n < 60; n++) {
        int order = 1 + (int)draw(5), column, precision = 10 + (int)draw(200);
        size_t cells = (size_t)(order * order);
        mpq_t *V, *inverse = rationals(cells), *d = draw_matrix(order, 1), *A = rationals(cells),
                  *scaled = rationals(cells);
        do
            V = draw_matrix(order, order);
        while (!rational_inverse(order, (const mpq_t *)V, inverse, &column));
        draw_fraction(tau, 30, 20);
        mpq_abs(tau, tau);
        for (int i = 0; i < order * order; i++)
            mpq_mul(scaled[i], V[i], d[i % order]);
        rational_product(order, order, order, (const mpq_t *)scaled, (const mpq_t *)inverse, A);
        for (int k = 0; k < order; k++) {
            mpq_mul(factor, d[k], tau);
            mpfr_set_q(e[k], factor, MPFR_RNDN);
            mpfr_exp(e[k], e[k], MPFR_RNDN);
        }
        mpfi_t *E = entries_of(taylor_of(order, (const mpq_t *)A, tau), order, precision);
        mpfr_set_zero(largest, 1);
        for (int round = 0; round < 2; round++)         /* the largest entry, then all */
            for (int i = 0; i < order * order; i++) {
                mpfr_set_zero(sum, 1);
                for (int k = 0; k < order; k++) {
                    mpq_mul(factor, V[i / order * order + k], inverse[k * order + i % order]);
                    mpfr_mul_q(term, e[k], factor, MPFR_RNDN);
                    mpfr_add(sum, sum, term, MPFR_RNDN);
                }
                if (round)
                    assert_interval("e^{A tau}", n, E[i], sum);
                if (round)
                    assert_narrow("e^{A tau}", n, E[i], mpfr_get_exp(largest) - precision + 1);
                else if (mpfr_cmpabs(sum, largest) > 0)
                    mpfr_abs(largest, sum, MPFR_RNDN);
            }
        entries_free(order, E);
    }
    mpq_clears(tau, factor, NULL);
    mpfr_clears(sum, term, largest, NULL);
    for (int k = 0; k < 5; k++)
        mpfr_clear(e[k]);
}

/* Of x' = [[0, 2^g], [-a b 2^-g, a + b]] x, a and b below 0 and rational, with few bits: there what the series leaves
 * out is more than what rounding does. With E the exponentials E11 = (a e^{b t} - b e^{a t})/(a - b) and
 * E12 = 2^g (e^{a t} - e^{b t})/(a - b), in states whose units differ by 2^g. */
static void taylor_of_few_bits(void **state)
{
    mpq_t a, b, tau, factor, none;
    mpfr_t truth;
    (void)state;
    mpq_inits(a, b, tau, factor, none, NULL);
    mpfr_init2(truth, TRUE_BITS);
    for (int n = 0; n < 300; n++) {
        int g = 2 * (int)draw(50) - 50;
        mpq_t *A = rationals(4);
        mpq_set_si(a, -1 - (long)draw(40), 1 + draw(40));
        mpq_canonicalize(a);
        mpq_set_si(b, -1 - (long)draw(20), 41 + draw(20));
        mpq_canonicalize(b);
        mpq_set_ui(tau, 1 + draw(20), 1 + draw(20));
        mpq_canonicalize(tau);
        mpq_sub(factor, a, b);
        if (mpq_sgn(factor) == 0)
            continue;
        mpq_set_ui(A[1], 1, 1);
        mpq_mul(A[2], a, b);
        mpq_neg(A[2], A[2]);
        mpq_add(A[3], a, b);
        for (int k = 0; k < (g < 0 ? -g : g); k++) {
            (g < 0 ? mpq_div_2exp : mpq_mul_2exp)(A[1], A[1], 1);
            (g < 0 ? mpq_mul_2exp : mpq_div_2exp)(A[2], A[2], 1);
        }
        mpfi_t *E = entries_of(taylor_of(2, (const mpq_t *)A, tau), 2, 2 + (int)draw(46));
        mpfr_set_zero(truth, 1);
        mpq_div(factor, A[1], factor);
        add_wave(truth, a, none, tau, factor, 0, false);
        mpq_neg(factor, factor);
        add_wave(truth, b, none, tau, factor, 0, false);
        assert_interval("E12", n, E[1], truth);
        mpfr_set_zero(truth, 1);
        mpq_div(factor, factor, A[1]);
        mpq_mul(none, factor, b);
        mpq_mul(factor, factor, a);
        mpq_neg(factor, factor);
        mpq_swap(none, factor);
        mpq_t zero;
        mpq_init(zero);
        add_wave(truth, a, zero, tau, factor, 0, false);
        add_wave(truth, b, zero, tau, none, 0, false);
        mpq_clear(zero);
        mpq_set_ui(none, 0, 1);
        assert_interval("E11", n, E[0], truth);
        entries_free(2, E);
    }
    mpq_clears(a, b, tau, factor, none, NULL);
    mpfr_clear(truth);
}

/* Where no circle is on the way entries are polynomials in tau: here in a triangle without diagonal, all are. */
static void taylor_of_a_chain(void **state)
{
    mpq_t tau, found;
    mpq_inits(tau, found, NULL);
    (void)state;
    for (int n = 0; n < 100; n++) {
        int order = 1 + (int)draw(6);
        mpq_t *A = draw_matrix(order, order), *sum = unit_matrix(order), *power = unit_matrix(order);
        mpq_t *next = draw_matrix(order, order);
        for (int i = 0; i < order * order; i++)
            if (i / order >= i % order)
                mpq_set_ui(A[i], 0, 1);
        mpq_set_ui(tau, 1 + draw(50), 1 + draw(50));
        mpq_canonicalize(tau);
        for (int k = 1; k < order; k++) {
            rational_product(order, order, order, (const mpq_t *)power, (const mpq_t *)A, next);
            for (int i = 0; i < order * order; i++) {
                mpq_mul(power[i], next[i], tau);
                mpq_set_ui(found, 1, (unsigned long)k);
                mpq_mul(power[i], power[i], found);
                mpq_add(sum[i], sum[i], power[i]);
            }
        }
        struct taylor *t = taylor_of(order, (const mpq_t *)A, tau);
        for (int i = 0; i < order * order; i++) {
            if (!taylor_exact(t, i / order, i % order, found))
                fail_msg("case %d: entry (%d, %d) of a chain is not found to be exact", n, i / order, i % order);
            assert_rational("polynomial in tau", n, i / order, i % order, found, sum[i]);
        }
        /* with a circle through one state, what leads from it or to it is none */
        int at = (int)draw((uint32_t)order);
        mpq_set_si(A[at * order + at], -1, 1);
        t = taylor_of(order, (const mpq_t *)A, tau);
        for (int i = 0; i < order; i++) {
            if (taylor_exact(t, i, at, found) && (i == at || mpq_sgn(A[i * order + at]) != 0))
                fail_msg("case %d: entry (%d, %d) holds an exponential and is found exact: %s", n, i, at,
                    mpq_get_str(NULL, 10, found));
        }
    }
    mpq_clears(tau, found, NULL);
}

/* ---- numbers that follow from others, by what made them ---- */

enum { GIVEN = 3, MADE = 40, PLACES = 3, SIDE = 3 };

static void draw_places(mpq_t *given)
{
    for (int i = 0; i < PLACES * GIVEN; i++) {
        mpq_set_si(given[i], (draw(2) ? 1 : -1) * (1000000 + (long)draw(1000000)), 1000 + draw(1000));
        mpq_canonicalize(given[i]);
    }
}

static void part_at(const struct traced_part *part, mpq_t *value, mpq_ptr result)
{
    mpq_set(result, part->number < 0 ? part->constant : value[part->number]);
    if (part->negative)
        mpq_neg(result, result);
}

/* Of all numbers of the record, where what is given has these values; false: something there is divided by 0 */
static bool record_at(const struct traced *number, int count, const mpq_t *given, mpq_t *value)
{
    mpq_t a, b;
    mpq_inits(a, b, NULL);
    bool defined = true;
    for (int i = 0; i < count && defined; i++) {
        const struct traced *n = &number[i];
        if (n->op == TRACED_GIVEN) {
            (n->a.negative ? mpq_neg : mpq_set)(value[i], given[n->a.number]);
            continue;
        }
        part_at(&n->a, value, a);
        part_at(&n->b, value, b);
        defined = n->op != TRACED_QUOTIENT || mpq_sgn(b) != 0;
        if (defined)
            (n->op == TRACED_SUM ? mpq_add : n->op == TRACED_PRODUCT ? mpq_mul : mpq_div)(value[i], a, b);
    }
    mpq_clears(a, b, NULL);
    return defined;
}

/* Numbers made at the first place, whose record was kept, and at two others: the record gives those of the last. */
static void assert_recorded(int n, int count, const mpq_t *given, mpq_t *const made[PLACES])
{
    int numbers;
    mpq_t expected;
    mpq_init(expected);
    for (int i = 0; i < count; i++)         /* 1 over a number of the record is entered where it is asked for */
        traced_as(made[0][i], made[1][i]);
    const struct traced *record = trace_record(&numbers);
    mpq_t *value = rationals((size_t)numbers);
    if (!record_at(record, numbers, given + (PLACES - 1) * GIVEN, value))
        return;
    for (int i = 0; i < count; i++) {
        const int number = traced_as(made[0][i], made[1][i]);
        if (number < 0)
            assert_rational("a constant", n, i, 0, made[PLACES - 1][i], made[0][i]);
        if (number < 0)
            continue;
        (mpq_sgn(made[0][i]) < 0 ? mpq_neg : mpq_set)(expected, value[number]);
        assert_rational("a number of the record", n, i, 0, made[PLACES - 1][i], expected);
    }
    mpq_clear(expected);
}

struct operation { int op, a, b; mpq_t constant; };

static bool perform(const struct operation *program, const mpq_t *given, mpq_t *x)
{
    for (int k = 0; k < GIVEN; k++)
        mpq_set(x[k], given[k]);
    for (int i = GIVEN; i < MADE; i++) {
        const struct operation *o = &program[i];
        mpq_srcptr b = o->b < 0 ? o->constant : x[o->b];
        if ((o->op == 3 && mpq_sgn(b) == 0) || (o->op == 4 && mpq_sgn(x[o->a]) == 0))
            return false;
        switch (o->op) {
        case 0:  mpq_add(x[i], x[o->a], b); break;
        case 1:  mpq_sub(x[i], x[o->a], b); break;
        case 2:  mpq_mul(x[i], x[o->a], b); break;
        case 3:  mpq_div(x[i], x[o->a], b); break;
        case 4:  mpq_inv(x[i], x[o->a]); break;
        default: mpq_neg(x[i], x[o->a]);
        }
    }
    return true;
}

static void record_of_programs(void **state)
{
    (void)state;
    for (int n = 0; n < 200; n++) {
        struct operation program[MADE];
        mpq_t *given = rationals(PLACES * GIVEN), *made[PLACES];
        bool defined = true;
        draw_places(given);
        for (int i = GIVEN; i < MADE; i++) {
            program[i] = (struct operation){ .op = (int)draw(6) };
            program[i].a = (int)draw((unsigned)i);
            program[i].b = (int)draw((unsigned)i + 3);
            mpq_init(program[i].constant);
            draw_fraction(program[i].constant, 5, 3);
            program[i].b = program[i].b < i ? program[i].b : -1;
            if (i > 12)             /* what they are made of stays small */
                program[i].a = (int)draw(8);
        }
        trace_from(GIVEN, given, given + GIVEN);
        for (int p = 0; p < PLACES && defined; p++) {
            made[p] = rationals(MADE);
            defined = perform(program, given + p * GIVEN, made[p]);
            trace_pause();
        }
        if (defined)
            assert_recorded(n, MADE, given, made);
    }
}

static void record_of_matrices(void **state)
{
    (void)state;
    for (int n = 0; n < 40; n++) {
        mpq_t *given = rationals(PLACES * GIVEN), *made[PLACES];
        int fixed[SIDE * SIDE], column;
        bool regular = true;
        draw_places(given);
        for (int i = 0; i < SIDE * SIDE; i++)
            fixed[i] = (int)draw(6) - 3;
        trace_from(GIVEN, given, given + GIVEN);
        for (int p = 0; p < PLACES && regular; p++) {
            mpq_t *A = rationals(SIDE * SIDE);
            made[p] = rationals(2 * SIDE * SIDE);
            for (int i = 0; i < SIDE * SIDE; i++)
                if (fixed[i] < 0)
                    mpq_set(A[i], given[p * GIVEN - fixed[i] - 1]);
                else
                    mpq_set_si(A[i], fixed[i], 1);
            regular = rational_inverse(SIDE, A, made[p], &column);
            rational_product(SIDE, SIDE, SIDE, A, A, made[p] + SIDE * SIDE);
            trace_pause();
        }
        if (regular)
            assert_recorded(n, 2 * SIDE * SIDE, given, made);
    }
}

/* Neither what was not made by what is recorded nor what differs elsewhere is one of its numbers. */
static void record_of_others(void **state)
{
    (void)state;
    mpq_t *given = rationals(PLACES * GIVEN), *other = rationals(2);
    draw_places(given);
    trace_from(GIVEN, given, given + GIVEN);
    mpz_mul(mpq_numref(other[0]), mpq_numref(given[0]), mpq_numref(given[1]));
    mpq_mul(other[1], given[0], given[1]);
    trace_pause();
    assert_int_equal(traced_as(given[0], given[GIVEN]), 0);
    assert_int_equal(traced_as(given[0], given[GIVEN + 1]), -1);
    assert_int_equal(traced_as(other[0], given[GIVEN]), -1);
    assert_int_equal(traced_as(other[1], given[GIVEN]), -1);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(poly_values),
        cmocka_unit_test(poly_content_times_primitive),
        cmocka_unit_test(poly_product_divided),
        cmocka_unit_test(poly_common_divisor),
        cmocka_unit_test(poly_common_divisor_beyond_the_screen),
        cmocka_unit_test(poly_square_free_factors),
        cmocka_unit_test(polymat_times_adjugate),
        cmocka_unit_test(polymat_blocks),
        cmocka_unit_test(matrix_products),
        cmocka_unit_test(matrix_inverse),
        cmocka_unit_test(matrix_free_column),
        cmocka_unit_test(matrix_of_a_state),
        cmocka_unit_test(echelon_against_its_rows),
        cmocka_unit_test(rectangle_exponential),
        cmocka_unit_test(null_rectangles_of_sums),
        cmocka_unit_test(roots_multiplied_back),
        cmocka_unit_test(residues_of_double_pairs),
        cmocka_unit_test(residues_of_powers_of_time),
        cmocka_unit_test(residues_of_real_poles),
        cmocka_unit_test(a_response_asked_anew),
        cmocka_unit_test(responses_along_a_course),
        cmocka_unit_test(taylor_times_its_inverse),
        cmocka_unit_test(taylor_doubled_twice),
        cmocka_unit_test(taylor_of_sums),
        cmocka_unit_test(taylor_of_known_eigenvalues),
        cmocka_unit_test(taylor_of_few_bits),
        cmocka_unit_test(taylor_of_a_chain),
        cmocka_unit_test(record_of_programs),
        cmocka_unit_test(record_of_matrices),
        cmocka_unit_test(record_of_others),
    };
    choose_cases(argc, argv);
    memory_open();
    const int status = cmocka_run_group_tests(tests, NULL, NULL);
    memory_close();
    return status;
}
