/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Units: texts such as "kN s/m" to exponents of the seven base units and an exact factor. */
#include "read/read.h"

#include <string.h>

/* ---- what is known ---- */

/* `factor`: a decimal, to the coherent SI unit of `base`; `pi`: the power of pi that goes with it, an angle */
static const struct known_unit {
	const char *name, *factor, *divisor;
	int pi;
	signed char base[UNIT_BASES];   /* m kg s A K mol cd */
	bool prefixed;
} units[] = {
	{ "m", "1", "1", 0, { 1 }, true }, { "g", "0.001", "1", 0, { 0, 1 }, true },
	{ "s", "1", "1", 0, { 0, 0, 1 }, true }, { "A", "1", "1", 0, { 0, 0, 0, 1 }, true },
	{ "K", "1", "1", 0, { 0, 0, 0, 0, 1 }, true }, { "mol", "1", "1", 0, { 0, 0, 0, 0, 0, 1 }, true },
	{ "cd", "1", "1", 0, { 0, 0, 0, 0, 0, 0, 1 }, true }, { "rad", "1", "1", 0, { 0 }, true },
	{ "deg", "1", "180", 1, { 0 }, false }, { "rev", "2", "1", 1, { 0 }, false },
	{ "rpm", "2", "60", 1, { 0, 0, -1 }, false }, { "Hz", "1", "1", 0, { 0, 0, -1 }, true },
	{ "N", "1", "1", 0, { 1, 1, -2 }, true }, { "Pa", "1", "1", 0, { -1, 1, -2 }, true },
	{ "J", "1", "1", 0, { 2, 1, -2 }, true }, { "W", "1", "1", 0, { 2, 1, -3 }, true },
	{ "C", "1", "1", 0, { 0, 0, 1, 1 }, true }, { "V", "1", "1", 0, { 2, 1, -3, -1 }, true },
	{ "F", "1", "1", 0, { -2, -1, 4, 2 }, true }, { "ohm", "1", "1", 0, { 2, 1, -3, -2 }, true },
	{ "S", "1", "1", 0, { -2, -1, 3, 2 }, true }, { "Wb", "1", "1", 0, { 2, 1, -2, -1 }, true },
	{ "T", "1", "1", 0, { 0, 1, -2, -1 }, true }, { "H", "1", "1", 0, { 2, 1, -2, -2 }, true },
	{ "min", "60", "1", 0, { 0, 0, 1 }, false }, { "h", "3600", "1", 0, { 0, 0, 1 }, false },
	{ "L", "0.001", "1", 0, { 3 }, true }, { "l", "0.001", "1", 0, { 3 }, true },
	{ "t", "1000", "1", 0, { 0, 1 }, true }, { "bar", "100000", "1", 0, { -1, 1, -2 }, true },
	{ "atm", "101325", "1", 0, { -1, 1, -2 }, false }, { "in", "0.0254", "1", 0, { 1 }, false },
	{ "ft", "0.3048", "1", 0, { 1 }, false }, { "yd", "0.9144", "1", 0, { 1 }, false },
	{ "mi", "1609.344", "1", 0, { 1 }, false }, { "lb", "0.45359237", "1", 0, { 0, 1 }, false },
	{ "lbf", "4.4482216152605", "1", 0, { 1, 1, -2 }, false },
	{ "kgf", "9.80665", "1", 0, { 1, 1, -2 }, false },
	{ "slug", "4.4482216152605", "0.3048", 0, { 0, 1 }, false },
	{ "psi", "4.4482216152605", "0.00064516", 0, { -1, 1, -2 }, false },
	{ "hp", "745.69987158227022", "1", 0, { 2, 1, -3 }, false },
	{ "gn", "9.80665", "1", 0, { 1, 0, -2 }, false }
};
enum { UNITS = sizeof units / sizeof *units };

static const struct { const char *text; int power; } prefixes[] = {
	{ "f", -15 }, { "p", -12 }, { "n", -9 }, { "u", -6 }, { "\xc2\xb5", -6 }, { "\xce\xbc", -6 }, { "m", -3 },
	{ "c", -2 }, { "da", 1 }, { "d", -1 }, { "h", 2 }, { "k", 3 }, { "M", 6 }, { "G", 9 }, { "T", 12 }
};

/* Signs of paper for names that are written in letters */
static const struct { const char *text, *name; } signs[] = {
	{ "\xce\xa9", "ohm" }, { "\xe2\x84\xa6", "ohm" }, { "\xc2\xb0", "deg" }
};

/* What has an offset or is a logarithm is no multiple of anything. */
static const struct { const char *name, *why; } refused[] = {
	{ "degC", "a temperature from another zero; a difference is in K" },
	{ "degF", "a temperature from another zero; a difference is in K, 5/9 of it" },
	{ "celsius", "a temperature from another zero; a difference is in K" },
	{ "dB", "the logarithm of a ratio, and no unit to multiply" },
	{ "dBA", "the logarithm of a ratio, and no unit to multiply" },
	{ "Np", "the logarithm of a ratio, and no unit to multiply" }
};

/* ---- units as values ---- */

static struct unit *unit_one(void)
{
	struct unit *unit = NEW(struct unit);
	unit->base = rationals(UNIT_BASES);
	mpq_init(unit->factor);
	mpq_set_ui(unit->factor, 1, 1);
	return unit;
}

/* 0.0254 */
static void decimal(const char *text, mpq_ptr value)
{
	const char *point = strchr(text, '.');
	const size_t whole = point ? (size_t)(point - text) : strlen(text);
	mpz_set_str(mpq_numref(value), format("%.*s%s", (int)whole, text, point ? point + 1 : ""), 10);
	mpz_ui_pow_ui(mpq_denref(value), 10, point ? strlen(point + 1) : 0);
	mpq_canonicalize(value);
}

static void scale_by_ten(struct unit *unit, int power)
{
	RATIONAL ten = RATIO(10, 1);
	for (int i = 0; i < (power < 0 ? -power : power); i++)
		(power < 0 ? mpq_div : mpq_mul)(unit->factor, unit->factor, ten);
}

static struct unit *unit_of_row(const struct known_unit *row)
{
	struct unit *unit = unit_one();
	RATIONAL divisor = ZERO;
	decimal(row->factor, unit->factor);
	decimal(row->divisor, divisor);
	mpq_div(unit->factor, unit->factor, divisor);
	unit->pi = row->pi;
	unit->angle = row->pi > 0 || strcmp(row->name, "rad") == 0;
	for (int i = 0; i < UNIT_BASES; i++)
		mpq_set_si(unit->base[i], row->base[i], 1);
	return unit;
}

static const struct known_unit *row_named(const char *name, size_t length)
{
	for (int i = 0; i < UNITS; i++)
		if (strlen(units[i].name) == length && strncmp(units[i].name, name, length) == 0)
			return &units[i];
	return NULL;
}

/* A name by itself before a prefix and a name: min, ft, cd. NULL: there is none. */
static struct unit *unit_named(const char *name, size_t length)
{
	const struct known_unit *row = row_named(name, length);
	if (row)
		return unit_of_row(row);
	for (size_t i = 0; i < sizeof prefixes / sizeof *prefixes; i++) {
		size_t prefix = strlen(prefixes[i].text);
		if (length <= prefix || strncmp(name, prefixes[i].text, prefix) != 0)
			continue;
		row = row_named(name + prefix, length - prefix);
		if (!row || !row->prefixed)
			continue;
		struct unit *unit = unit_of_row(row);
		scale_by_ten(unit, prefixes[i].power);
		return unit;
	}
	for (size_t i = 0; i < sizeof signs / sizeof *signs; i++) {
		const size_t sign = strlen(signs[i].text), before = length >= sign ? length - sign : 0;
		if (length < sign || strncmp(name + before, signs[i].text, sign) != 0)
			continue;
		const char *plain = format("%.*s%s", (int)before, name, signs[i].name);
		return unit_named(plain, strlen(plain));
	}
	return NULL;
}

bool is_unit_name(const char *name, size_t length)
{
	return unit_named(name, length);
}

/* ---- the text ---- */

struct unit_text {
	struct place at;            /* just behind the opening quote */
	const char *text;
	size_t position, end;
	bool divided;               /* a / stands before: a product behind it may be of either side */
	int nesting;
};

static struct place place_in(const struct unit_text *u)
{
	return (struct place){ u->at.source, u->at.offset + u->position };
}

static bool at_end(const struct unit_text *u) { return u->position >= u->end; }

static void skip_blanks(struct unit_text *u)
{
	while (!at_end(u) && strchr(" \t", u->text[u->position]))
		u->position++;
}

/* The bytes of a name: letters, and whatever is no ASCII but a raised digit or a product's dot */
static size_t name_length(const struct unit_text *u)
{
	size_t i = u->position;
	for (; i < u->end; i++) {
		unsigned char c = (unsigned char)u->text[i];
		bool raised = c == 0xc2 && strchr("\xb2\xb3\xb7", u->text[i + 1]);
		if (raised || !(c >= 0x80 || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '%'))
			break;
	}
	return i - u->position;
}

/* N m for Nm, where both are units */
static const char *parted(const char *name, size_t length)
{
	for (size_t i = 1; i < length; i++)
		if (row_named(name, i) && unit_named(name + i, length - i))
			return format("a product has a space: \"%.*s %.*s\"", (int)i, name, (int)(length - i),
				      name + i);
	return NULL;
}

static const char *unit_suggestion(const char *name, size_t length)
{
	static const struct { const char *name, *unit; } habit[] = {
		{ "sec", "s" }, { "degrees", "deg" }, { "degree", "deg" }, { "Ohm", "ohm" }, { "kmh", "km/h" },
		{ "kph", "km/h" }, { "mph", "mi/h" }, { "RPM", "rpm" }, { "hz", "Hz" }, { "KG", "kg" }, { "Kg", "kg" },
		{ "inch", "in" }, { "meter", "m" }, { "metre", "m" }, { "radian", "rad" }, { "newton", "N" },
		{ "hour", "h" },
		{ "turn", "rev" }, { "cm2", "cm^2" }, { "lbs", "lb" }, { "pa", "Pa" }, { "v", "V" }, { "n", "N" }
	};
	const char *word = format("%.*s", (int)length, name), *known[UNITS];
	for (size_t i = 0; i < sizeof habit / sizeof *habit; i++)
		if (strcmp(habit[i].name, word) == 0)
			return format("did you mean \"%s\"?", habit[i].unit);
	const char *product = parted(name, length);
	if (product)
		return product;
	for (int i = 0; i < UNITS; i++)
		known[i] = units[i].name;
	const char *nearest = nearest_name(word, UNITS, known);
	return nearest ? format("did you mean \"%s\"?", nearest)
		       : "units are m g s A K mol cd rad deg rpm Hz N Pa J W C V F ohm H T bar in ft lb lbf min h, "
			 "with prefixes";
}

static void multiply_by(struct unit *unit, const struct unit *by, mpq_srcptr power, struct place at)
{
	long n = mpz_get_si(mpq_numref(power));
	bool whole = mpz_cmp_ui(mpq_denref(power), 1) == 0;
	if (!whole && (mpq_cmp_ui(by->factor, 1, 1) != 0 || by->pi))
		error(at, NULL, "this unit has no power that is not whole: its factor to the SI unit is not 1");
	for (int i = 0; i < UNIT_BASES; i++)
		rational_addmul(unit->base[i], power, by->base[i]);
	for (long i = 0; whole && i < (n < 0 ? -n : n); i++)
		(n < 0 ? mpq_div : mpq_mul)(unit->factor, unit->factor, by->factor);
	unit->pi += whole ? (int)n * by->pi : 0;
	unit->angle += whole ? (int)n * by->angle : 0;
}

static bool take_sign(struct unit_text *u, char sign)
{
	skip_blanks(u);
	if (at_end(u) || u->text[u->position] != sign)
		return false;
	u->position++;
	return true;
}

/* integer: [ - ] DIGIT [ DIGIT ] */
static void read_integer(struct unit_text *u, mpq_ptr value)
{
	struct place at = place_in(u);
	bool minus = take_sign(u, '-');
	size_t digits = strspn(u->text + u->position, "0123456789");
	if (digits == 0 || digits > 2)
		error(at, "as in \"m/s^2\" or \"m^(1/2)\"", "the power of a unit is a whole number below 100, or a "
		      "quotient of two in brackets");
	long n = 0;
	for (; digits > 0; digits--)
		n = 10 * n + (u->text[u->position++] - '0');
	mpq_set_si(value, minus ? -n : n, 1);
}

/* exponent: ^ integer | ^ ( integer / integer ) | integer | a raised 2 or 3 */
static void read_exponent(struct unit_text *u, mpq_ptr power)
{
	RATIONAL below = ZERO;
	const char *next = u->text + u->position;
	mpq_set_ui(power, 1, 1);
	if (at_end(u))
		return;
	if (strncmp(next, "\xc2\xb2", 2) == 0 || strncmp(next, "\xc2\xb3", 2) == 0) {
		mpq_set_ui(power, next[1] == '\xb2' ? 2 : 3, 1);
		u->position += 2;
	} else if (*next == '^' && next[1] == '(') {
		u->position += 2;
		read_integer(u, power);
		if (take_sign(u, '/')) {
			struct place at = place_in(u);
			read_integer(u, below);
			if (mpq_sgn(below) == 0)
				error(at, NULL, "division by zero");
			mpq_div(power, power, below);
		}
		if (!take_sign(u, ')'))
			error(place_in(u), NULL, "expected ')' behind the power of a unit");
	} else if (*next == '^') {
		u->position++;
		read_integer(u, power);
	} else if ((*next >= '0' && *next <= '9') || (*next == '-' && next[1] >= '0' && next[1] <= '9')) {
		read_integer(u, power);
	}
}

static struct unit *read_unit_product(struct unit_text *u);

static struct unit *read_unit_bracket(struct unit_text *u)
{
	struct place opening = place_in(u);
	bool before = u->divided;
	u->position++;
	u->divided = false;
	if (++u->nesting > LIMIT_NESTING)
		error(opening, NULL, "nesting over the limit of %d", LIMIT_NESTING);
	struct unit *inner = read_unit_product(u);
	u->divided = before;
	u->nesting--;
	if (!take_sign(u, ')'))
		error(opening, NULL, "'(' is not closed in this unit");
	return inner;
}

static struct unit *read_unit_name(struct unit_text *u)
{
	size_t length = name_length(u);
	const char *name = u->text + u->position;
	struct place at = place_in(u);
	for (size_t i = 0; i < sizeof refused / sizeof *refused; i++)
		if (strlen(refused[i].name) == length && strncmp(refused[i].name, name, length) == 0)
			error(at, NULL, "'%s' is %s", refused[i].name, refused[i].why);
	if (length > 2 && strncmp(name, "\xc2\xb0", 2) == 0 && strchr("CF", name[2]))
		error(at, NULL, "'%.*s' is %s", (int)length, name, refused[0].why);
	struct unit *unit = unit_named(name, length);
	if (!unit)
		error(at, unit_suggestion(name, length), "unknown unit '%.*s'", (int)length, name);
	u->position += length;
	return unit;
}

/* factor: ( name | 1 | ( product ) ) [ exponent ] */
static void read_unit_factor(struct unit_text *u, struct unit *unit, bool inverse)
{
	RATIONAL power = ZERO;
	skip_blanks(u);
	struct place at = place_in(u);
	const char *next = u->text + u->position;
	size_t digits = at_end(u) ? 0 : strspn(next, "0123456789.");
	const struct unit *by;
	if (!at_end(u) && *next == '(') {
		by = read_unit_bracket(u);
	} else if (digits > 0) {
		if (digits > 1 || *next != '1')
			error(at, "how many it is stands before the unit, outside of the quotes",
			      "a unit holds no number but 1");
		u->position++;
		by = unit_one();
	} else if (at_end(u) || name_length(u) == 0) {
		error(at, "as in \"kN s/m\" or \"1/s\"", at_end(u) ? "expected a unit, found the end of the text"
								 : "expected a unit, found '%c'", *next);
	} else {
		by = read_unit_name(u);
	}
	read_exponent(u, power);
	if (inverse)
		mpq_neg(power, power);
	multiply_by(unit, by, power, at);
}

/* What stands between two factors: '*', '/', or 0: the end */
static char unit_operator(struct unit_text *u)
{
	size_t before = u->position;
	skip_blanks(u);
	if (at_end(u) || u->text[u->position] == ')')
		return 0;
	char c = u->text[u->position];
	if (c == '*' || c == '.' || c == '/') {
		u->position++;
		return c == '/' ? '/' : '*';
	}
	if ((unsigned char)c == 0xc2 && u->text[u->position + 1] == '\xb7') {
		u->position += 2;
		return '*';
	}
	if (u->position > before || c == '(')
		return '*';
	error(place_in(u), "as in \"kN s/m\" or \"m/s^2\"",
	      "expected '*', '/', '^' or a space between units, found '%c'", c);
}

/* product: factor { ( * | . | space | / ) factor } */
static struct unit *read_unit_product(struct unit_text *u)
{
	struct unit *unit = unit_one();
	char operator = '*';
	do {
		if (operator == '*' && u->divided)
			error(place_in(u), "brackets say which: \"W/(m K)\", or the product first: \"N s/m\"",
			      "is this factor below the '/' or above it?");
		u->divided = u->divided || operator == '/';
		read_unit_factor(u, unit, operator == '/');
	} while ((operator = unit_operator(u)) != 0);
	return unit;
}

struct unit *unit_parse(struct place at, const char *text, size_t length)
{
	struct unit_text u = { .at = at, .text = text, .end = length };
	struct unit *unit = read_unit_product(&u);
	if (!at_end(&u))
		error(place_in(&u), NULL, "')' without its '(' in this unit");
	const char *from = text + strspn(text, " \t");
	while (length > 0 && strchr(" \t", text[length - 1]))
		length--;
	unit->text = format("%.*s", (int)(length - (size_t)(from - text)), from);
	unit->at = (struct place){ at.source, at.offset - 1 };
	return unit;
}

double unit_factor(const struct unit *unit)
{
	REAL factor = WITH_BITS(IRRATIONAL_BITS), pi = WITH_BITS(IRRATIONAL_BITS);
	if (!unit)
		return 1;
	mpfr_const_pi(pi, MPFR_RNDN);
	mpfr_pow_si(pi, pi, unit->pi, MPFR_RNDN);
	mpfr_mul_q(factor, pi, unit->factor, MPFR_RNDN);
	return mpfr_get_d(factor, MPFR_RNDN);
}

bool is_coherent(const struct unit *unit)
{
	return mpq_cmp_ui(unit->factor, 1, 1) == 0 && unit->pi == 0;
}

struct unit *unit_of_derivative(const struct unit *of, int primes)
{
	struct unit *unit = unit_one();
	RATIONAL one = RATIO(1, 1), times = RATIO(-primes, 1);
	size_t length = strlen(of->text);
	bool per_second = length > 2 && strcmp(of->text + length - 2, "/s") == 0;
	multiply_by(unit, of, one, of->at);
	mpq_add(unit->base[2], unit->base[2], times);
	unit->at = of->at;
	unit->text = primes == 0  ? of->text
		     : per_second ? format("%s^%d", of->text, primes + 1)
				  : format("%s/s%s", of->text, primes > 1 ? "^2" : "");
	return unit;
}

/* ---- dimensions as text ---- */

static void add_power(char **text, const char *name, mpq_srcptr power)
{
	const char *exponent = mpq_cmp_ui(power, 1, 1) == 0                  ? ""
			       : mpz_cmp_ui(mpq_denref(power), 1) == 0 ? format("^%s", exact_text(power))
									: format("^(%s)", mpq_get_str(NULL, 10, power));
	*text = format("%s%s%s%s", *text, **text ? " " : "", name, exponent);
}

const char *base_unit_text(const mpq_t *base)
{
	static const char *const name[] = { "m", "kg", "s", "A", "K", "mol", "cd" };
	static const int order[] = { 1, 0, 2, 3, 4, 5, 6 };     /* kg m/s^2 */
	char *above = format("%s", ""), *below = above;
	RATIONAL inverse = ZERO;
	int divisors = 0;
	for (int k = 0; k < UNIT_BASES; k++) {
		mpq_srcptr power = base[order[k]];
		mpq_neg(inverse, power);
		if (mpq_sgn(power) > 0)
			add_power(&above, name[order[k]], power);
		else if (mpq_sgn(power) < 0)
			add_power(&below, name[order[k]], inverse);
		divisors += mpq_sgn(power) < 0;
	}
	return format(divisors > 1 ? "%s/(%s)" : divisors ? "%s/%s" : "%s%s", *above ? above : "1", below);
}

const char *si_unit_text(const mpq_t *base)
{
	static const char *const name[] = {
		"N", "N/m", "N s/m", "N m", "N m s", "W", "Pa", "Pa s", "V", "V/s", "C", "F", "ohm", "H", "T", "Wb",
		"N/m^2", "N/m^3", "N/V", "N s", "V/m", "J/K", "W/K", "W/(m K)", "J/(kg K)"
	};
	for (size_t i = 0; i < sizeof name / sizeof *name; i++) {
		const struct unit *unit = unit_parse((struct place){ NULL, 1 }, name[i], strlen(name[i]));
		if (rationals_equal(UNIT_BASES, unit->base, base))
			return name[i];
	}
	return base_unit_text(base);
}

/* Of deg the radian, of kN the newton */
const struct unit *unit_in_si(const struct unit *of)
{
	if (is_coherent(of))
		return of;
	struct unit *unit = unit_of_dimension((const mpq_t *)of->base);
	if (of->angle == 1 && unit->text[0] == '1') {
		unit->text = format("rad%s", unit->text + 1);
		unit->angle = 1;
	}
	return unit;
}

struct unit *unit_of_dimension(const mpq_t *base)
{
	struct unit *unit = unit_one();
	for (int i = 0; i < UNIT_BASES; i++)
		mpq_set(unit->base[i], base[i]);
	unit->text = si_unit_text(base);
	return unit;
}
