/* SPDX-License-Identifier: GPL-3.0-or-later */
/* mutate SEED GOOD... -- BAD...: a spec made by accident from good and bad ones, mostly good; the same for the same
 * seed and files. */
#include "random.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

uint64_t state;

enum { ROOM = 1 << 20 };

struct text {
	char *byte;
	size_t length;
};

static size_t index_below(size_t n)
{
	return n ? (size_t)(next() % n) : 0;
}

static struct text read_text(const char *path)
{
	struct text text = { malloc(ROOM), 0 };
	FILE *file = fopen(path, "rb");
	if (!file || !text.byte) {
		perror(path);
		exit(1);
	}
	text.length = fread(text.byte, 1, ROOM / 4, file);
	fclose(file);
	return text;
}

/* The bytes from `at` on, `removed` of them, give way to others. */
static void replace(struct text *text, size_t at, size_t removed, const char *byte, size_t length)
{
	if (text->length - removed + length > ROOM / 2)
		return;
	memmove(text->byte + at + length, text->byte + at + removed, text->length - at - removed);
	memcpy(text->byte + at, byte, length);
	text->length += length - removed;
}

static int is_word(char c)
{
	return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '.';
}

/* A token around a random place: a word with its primes, or one other byte. */
static size_t token(const struct text *text, size_t *at)
{
	size_t from = *at = index_below(text->length), until;
	if (text->length == 0)
		return 0;
	while (from > 0 && is_word(text->byte[from]) && is_word(text->byte[from - 1]))
		from--;
	for (until = from; until < text->length && is_word(text->byte[until]);)
		until++;
	while (until > from && until < text->length && text->byte[until] == '\'')
		until++;
	*at = from;
	return until > from ? until - from : 1;
}

/* The line around a random place, its end included. */
static size_t line(const struct text *text, size_t *at)
{
	size_t from = *at = index_below(text->length), until;
	while (from > 0 && text->byte[from - 1] != '\n')
		from--;
	for (until = from; until < text->length && text->byte[until] != '\n';)
		until++;
	*at = from;
	return until + (until < text->length) - from;
}

static void flip_byte(struct text *text)
{
	if (text->length)
		text->byte[index_below(text->length)] ^= (char)(1 << index_below(8));
}

static void set_byte(struct text *text)
{
	static const char likely[] = "()[]{};,=+-*/^<>?:'\"#.\n\t 0123456789etx_!\\\r\0\xff\xc3";
	char byte = likely[index_below(sizeof likely)];
	size_t at = index_below(text->length + 1);
	replace(text, at, at < text->length && index_below(2), &byte, 1);
}

static void remove_token(struct text *text)
{
	size_t at, length = token(text, &at);
	replace(text, at, length, "", 0);
}

static void double_token(struct text *text)
{
	size_t at, length = token(text, &at);
	char *copy = malloc(length + 2);
	copy[0] = ' ';
	memcpy(copy + 1, text->byte + at, length);
	replace(text, at + length, 0, copy, length + 1);
	free(copy);
}

/* A token of this or another spec in the place of a token of this one. */
static void splice_token(struct text *text, const struct text *other)
{
	const struct text *from = index_below(2) ? other : text;
	size_t at, there, length = token(text, &at), taken = token(from, &there);
	char *copy = malloc(taken + 1);
	memcpy(copy, from->byte + there, taken);
	replace(text, at, length, copy, taken);
	free(copy);
}

static void insert_word(struct text *text)
{
	static const char *const word[] = { "model",
										"param ",
										"coord ",
										"init ",
										"let ",
										"output ",
										"step ",
										"scheme pl\n",
										"input u\n",
										"sin(",
										"cos(",
										"exp(",
										"log(",
										"sqrt(",
										"abs(",
										"atan2(",
										"min(",
										"clip(",
										"deadzone(",
										"table(",
										"pi",
										"t",
										"x''",
										"x1'",
										"1/0",
										"0^0",
										"^-1",
										"^0.5",
										"^2^3",
										"''",
										"(",
										")",
										"((((((((",
										"))))))))",
										"?",
										"? 1 : 0",
										"==",
										"<= ",
										"1e9999",
										"1e-9999",
										"1e308",
										"-",
										"- - - -",
										"# ",
										"\"",
										",",
										";",
										"= 0",
										"0*",
										"*t",
										"matrix ",
										"input u hold first\n",
										"hold first",
										"mass 1 at ",
										"spring 3 between ",
										"damper 0.1 between ",
										"force ",
										", ground",
										" on ",
										"u",
										"u'",
										"q[2]",
										"q[2]'",
										"[2]",
										"[1",
										"[2, -1; -1, 2]",
										"[1; 2]",
										"*[",
										"]",
										"t < 1 ? ",
										" : 0",
										"t^3",
										"t^33",
										"t*",
										"exp(-2*t)",
										"exp(t)*cos(3*t)",
										"table(t; 0, 0; 1, 2; 3, 1)",
										"abs(t - 1)",
										"max(t, 0.005)",
										"\"mtx_good.mtx\"",
										"operator at ",
										"at x = 0",
										", x' = 1",
										", t = 2",
										", 0, 4, 8",
										"scheme etdrk4\n",
										"scheme nc3\n",
										"scheme bm3\n",
										"etd1",
										"etdrk2",
										"nc2",
										"dq4",
										"x^3",
										"*x^2",
										"*x1*x2",
										"*x'",
										"*u",
										"tan(",
										"sgn(",
										"sinh(",
										"cosh(",
										"tanh(",
										"asin(",
										"acos(",
										"atan(",
										"max(",
										"table(x; -1, 2; 0, 0; 1, 3)",
										"clip(x1, -0.1, 0.1)",
										"deadzone(x', -1, 1)",
										"1/x",
										"x^-1",
										"x^x",
										"x^1.5",
										"x > 0 ? x : 0",
										"x' < t ? 1 : ",
										"sqrt(x^2 + 1)",
										"atan2(x, x')",
										"min(x, t)",
										"cos(t)*x",
										"x*x''",
										"sin(x'')",
										"\n",
										"\r\n",
										"\xef\xbb\xbf",
										"\xcf\x89" };
	size_t at, choice = index_below(sizeof word / sizeof *word);
	token(text, &at);
	replace(text, at, 0, word[choice], strlen(word[choice]));
}

/* A whole statement, at the start of a line. Most name what they need, so that a spec stays good more often than by
 * splicing. */
static void insert_statement(struct text *text)
{
	static const char *const statement[] = {
		"coord q[2]\n",
		"coord q[3], z\n",
		"q'' + q = 0\n",
		"q' + q = 0\n",
		"M*q'' + C*q' + K*q = f*cos(w*t)\n",
		"q' = K*q + f*u\n",
		"z' + z = x\n",
		"z'' + z = q[1]\n",
		"coord z\n",
		"coord z\nz' = -z\n",
		"coord z\nz' + 2*z = x1\n",
		"coord q[2]\nmatrix K = [2, -1; -1, 2]\nq'' + K*q = 0\n",
		"coord q[2]\nmatrix K = [2, -1; -1, 2], f = [1; t]\nq' + K*q = f\n",
		"coord q[2]\nmatrix K = \"mtx_good.mtx\", M = 3*K + K*K\n"
		"M*q'' + 0.1*K*q' + K*q = [1; 0]*(t < 0.005 ? sin(t) : 0)\n",
		"matrix K = \"mtx_good.mtx\"\n",
		"matrix M = [1, 0; 0, 2]\n",
		"matrix f = [1; 0]\n",
		"matrix C = 0.1*M + 0.01*K\n",
		"init q[2] = 1, q[1]' = 2\n",
		"init q = [1; 2]\n",
		"output q, q'\n",
		"output s = [1, 1]*q\n",
		"output q''\n",
		"output x1''\n",
		"output a = 2*x1'' - u + t\n",
		"output x1, s = x1 + x2\n",
		"output e = x1^2 + sin(x2)\n",
		"output d = t < 0.015 ? x1 : x2\n",
		"input u\n",
		"input u hold first\n",
		"input u hold first, v\n",
		"input u\ncoord z\nz'' + 4*z = u\noutput z''\n",
		"input u hold first\ncoord z\nz'' + 4*z = 3*u + u'\n",
		"mass 1 at x\n",
		"mass m1 at x1\n",
		"mass 2 at q[2]\n",
		"spring k1 between x1, ground\n",
		"spring 3 between x, y\n",
		"damper 0.2 between x1, x2\n",
		"force cos(3*t) on x1\n",
		"force u on x1\n",
		"coord z\nmass 1 at z\nspring 100 between z, ground\nforce exp(-t) on z\n",
		"coord z\ndamper 1 between z, x1\nspring 2 between z, ground\n",
		"let s = t < 0.015 ? 10*sin(pi*t/0.6) : 0\n",
		"let s = table(t; 0, 0; 0.013, 2; 0.025, 1)\n",
		"let s = t^3*exp(-2*t)*cos(3*t)\n",
		"coord z\nz'' = s\n",
		"coord z\nz'' + 25*z = t*cos(5*t)\n",
		"coord z\nz'' + 25*z = clip(t, 0.002, 0.0133) + max(0, t - 0.01)\n",
		"scheme pl\n",
		"scheme exact\n",
		"scheme etd1\n",
		"scheme etdrk2\n",
		"scheme etdrk4\n",
		"scheme nc2\n",
		"scheme nc3\n",
		"scheme dq4\n",
		"scheme bm3\n",
		"operator at x = 0\n",
		"operator at x = 2, x' = 0\n",
		"operator at t = pi/2\n",
		"operator at x = 0, y = 1, t = 3\n",
		"operator at x1 = 0, x2' = 1\n",
		"operator at q = 0\n",
		"operator at q[1] = 1, q[2] = 2\n",
		"operator at w = 0, 4, 8, 15\n",
		"operator at t = 0, 0.01, 0.02\n",
		"operator at x = -1, 0, 1, x' = 2\n",
		"let w = 3*t\noperator at w = 0, 0.01, 0.02\n",
		"let w = x^2 + t\noperator at w = 1\n",
		"let w = t < 0.01 ? t : 0.01\noperator at w = 0.005, 0.01\n",
		"coord z\nz'' + z + z^3 = cos(2*t)\n",
		"coord z\nz'' + sin(z) = 0\n",
		"coord z\nz'' - 5*(1 - z^2)*z' + z = 0\n",
		"coord z\nz' = -z^2 + x\n",
		"coord z\nz'' + (1 - cos(2*t))*z = 0\n",
		"input u\ncoord z\nz'' + z + z^3 = u\n",
		"input u hold first\ncoord z\nz'' + z*u + abs(z) = u'\n",
		"coord z\nz'' + tanh(20*z') + 4*z = exp(-t)\noutput z''\n",
		"coord q[2]\nmatrix K = [2, -1; -1, 2]\nq'' + K*q + 0.1*q^3 = [1; 0]*cos(t)\n",
		"coord q[2], z\nmatrix K = [2, -1; -1, 2]\nlet w = sin(t)\nq'' + (K + w^2*K)*q + sin(q) = 0\n"
		"z'' + z = abs(z) + q[1]*q[2]\n",
		"coord z\nz'' + z = min(z, 0.1) + table(z; 0, 0; 1, 2) + clip(z', -1, 1)*deadzone(z, -0.1, 0.1)\n",
		"coord z\ninit z = 1\nz'' + 1/z + log(z) + sqrt(z) + z^1.5 = 0\n",
		"coord z\nmass 1 at z\nspring 2 between z, ground\nforce -z^3 - sgn(z') on z\n",
		"coord z\nz'' = z > t ? -z^2 : z*t\n",
		"let p = x^2\nlet r = p^2 + sin(p)\n",
		"force -x1^3 on x1\n"
	};
	size_t at, choice = index_below(sizeof statement / sizeof *statement);
	line(text, &at);
	replace(text, at, 0, statement[choice], strlen(statement[choice]));
}

static void remove_line(struct text *text)
{
	size_t at, length = line(text, &at);
	replace(text, at, length, "", 0);
}

/* A line of this or another spec at the start of a line of this one. */
static void splice_line(struct text *text, const struct text *other)
{
	const struct text *from = index_below(2) ? other : text;
	size_t at, there, taken = line(from, &there);
	char *copy = malloc(taken + 1);
	memcpy(copy, from->byte + there, taken);
	line(text, &at);
	replace(text, at, 0, copy, taken);
	free(copy);
}

/* A number becomes another: huge, tiny, 0, negative, malformed. */
static void blow_number(struct text *text)
{
	static const char *const number[] = { "0",
		"-1",
		"1e300",
		"1e-300",
		"1e9999",
		"1e-9999",
		"1e99999",
		"99999999999999999999999999",
		"0.1000000000000000000000000000000001",
		"1.2.3",
		"1e",
		"2^1000",
		"2^-1000",
		"2^2000000",
		"pi",
		"sqrt(2)",
		"exp(50)",
		"1/3",
		"(1/7)^30",
		"0.0",
		"-0",
		"1e5",
		"1e-5",
		"4503599627370497",
		"2147483648",
		"18446744073709551616" };
	size_t choice = index_below(sizeof number / sizeof *number);
	for (int tries = 0; tries < 50; tries++) {
		size_t at, length = token(text, &at);
		if (length && text->byte[at] >= '0' && text->byte[at] <= '9') {
			replace(text, at, length, number[choice], strlen(number[choice]));
			return;
		}
	}
}

static void cut(struct text *text)
{
	text->length = index_below(text->length + 1);
}

/* One byte many times. */
static void repeat_byte(struct text *text)
{
	static const char likely[] = "(-[)^1x \n'?";
	char many[2000];
	size_t length = index_below(6) ? index_below(40) : index_below(sizeof many);
	memset(many, likely[index_below(sizeof likely - 1)], sizeof many);
	replace(text, index_below(text->length + 1), 0, many, length);
}

static void mutate(struct text *text, const struct text *other)
{
	switch (index_below(20)) {
	case 0: flip_byte(text); break;
	case 1: set_byte(text); break;
	case 2: remove_token(text); break;
	case 3: double_token(text); break;
	case 4: case 5: case 6: splice_token(text, other); break;
	case 7: case 8: insert_word(text); break;
	case 9: remove_line(text); break;
	case 10: case 11: splice_line(text, other); break;
	case 12: case 13: case 14: blow_number(text); break;
	case 15: case 16: case 17: case 18: insert_statement(text); break;
	default:
		if (index_below(4))
			repeat_byte(text);
		else
			cut(text);
	}
}

int main(int argc, char **argv)
{
	int split = 2;
	while (split < argc && strcmp(argv[split], "--") != 0)
		split++;
	if (split < 3 || split + 1 >= argc) {
		fputs("usage: mutate SEED GOOD... -- BAD...\n", stderr);
		return 2;
	}
	size_t good = (size_t)split - 2, bad = (size_t)(argc - split) - 1;
	state = strtoull(argv[1], NULL, 10) * UINT64_C(0x2545f4914f6cdd1d);
	struct text text = read_text(index_below(4) ? argv[2 + index_below(good)] : argv[split + 1 + index_below(bad)]);
	struct text other = read_text(index_below(2) ? argv[2 + index_below(good)]
				      : argv[split + 1 + index_below(bad)]);
	for (size_t count = 1 + index_below(5); count > 0; count--)
		mutate(&text, &other);
	size_t written = fwrite(text.byte, 1, text.length, stdout);
	free(other.byte);
	int failed = written != text.length;
	free(text.byte);
	return fflush(stdout) != 0 || failed;
}
