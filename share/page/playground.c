/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the generator has in a page in the place of clang: libtcc writes the instructions of a 64-bit RISC-V processor
 * (The RISC-V Instruction Set Manual, volume I, RV64IMFD), and here they are carried out, each product and each sum of
 * doubles rounded as everywhere. Addresses are those of this program. */
#include "command.h"
#include "run/run.h"
#include "run_texts.h"

#include <libtcc.h>
#include <math.h>
#ifdef __wasm__
#include <pthread.h>
#endif
#include <stdlib.h>
#include <string.h>

enum { STACK = 1 << 22, WORD = 8, OUTSIDE = 64 };  /* addresses below are functions that are not emulated */

typedef union { double d; float f; uint64_t bits; } real_register;
static struct { uint64_t x[32]; real_register f[32]; } r;
static _Alignas(16) unsigned char stack[STACK];

static const char *const outside[] = { "", "memcpy", "memmove", "memset" };

static uint64_t call_outside(uint64_t which)
{
	void *to = (void *)(uintptr_t)r.x[10];
	const void *from = (const void *)(uintptr_t)r.x[11];
	if (which == 3)
		memset(to, (int)r.x[11], r.x[12]);
	else
		memmove(to, from, r.x[12]);
	return r.x[1];
}

/* `by` bits from bit `from` on, with sign */
static int64_t field(uint32_t word, int from, int by)
{
	return (int32_t)(word << (32 - from - by)) >> (32 - by);
}

static uint64_t load(uint64_t address, int kind)
{
	const void *at = (const void *)(uintptr_t)address;
	switch (kind) {
	case 0:  return (uint64_t)*(const int8_t *)at;
	case 1:  return (uint64_t)*(const int16_t *)at;
	case 2:  return (uint64_t)*(const int32_t *)at;
	case 4:  return *(const uint8_t *)at;
	case 5:  return *(const uint16_t *)at;
	case 6:  return *(const uint32_t *)at;
	default: return *(const uint64_t *)at;
	}
}

static void store(uint64_t address, uint64_t value, int kind)
{
	void *at = (void *)(uintptr_t)address;
	switch (kind) {
	case 0:  *(uint8_t *)at = (uint8_t)value; break;
	case 1:  *(uint16_t *)at = (uint16_t)value; break;
	case 2:  *(uint32_t *)at = (uint32_t)value; break;
	default: *(uint64_t *)at = value;
	}
}

static uint64_t calculated(int kind, bool other, uint64_t a, uint64_t b)
{
	switch (kind) {
	case 0:  return other ? a - b : a + b;
	case 1:  return a << (b & 63);
	case 2:  return (int64_t)a < (int64_t)b;
	case 3:  return a < b;
	case 4:  return a ^ b;
	case 5:  return other ? (uint64_t)((int64_t)a >> (b & 63)) : a >> (b & 63);
	case 6:  return a | b;
	default: return a & b;
	}
}

static uint64_t calculated_in_32(int kind, bool other, uint32_t a, uint32_t b)
{
	return (uint64_t)(int32_t)(kind == 1		? a << (b & 31)
				   : kind == 5 && other ? (uint32_t)((int32_t)a >> (b & 31))
				   : kind == 5		? a >> (b & 31)
				   : other		? a - b
							: a + b);
}

static uint64_t multiplied(int kind, uint64_t a, uint64_t b)
{
	const int64_t c = (int64_t)a, d = (int64_t)b;
	switch (kind) {
	case 0:  return a * b;
	case 4:  return d == 0 ? UINT64_MAX : d == -1 ? -a : (uint64_t)(c / d);
	case 5:  return b == 0 ? UINT64_MAX : a / b;
	case 6:  return d == 0 ? a : d == -1 ? 0 : (uint64_t)(c % d);
	default: return b == 0 ? a : a % b;
	}
}

static uint64_t multiplied_in_32(int kind, uint64_t a, uint64_t b)
{
	const bool plain = kind == 5 || kind == 7;
	return (uint64_t)(int32_t)multiplied(kind, plain ? (uint32_t)a : (uint64_t)(int32_t)a,
					     plain ? (uint32_t)b : (uint64_t)(int32_t)b);
}

static bool holds(int kind, uint64_t a, uint64_t b)
{
	const bool result = kind < 4 ? a == b : kind < 6 ? (int64_t)a < (int64_t)b : a < b;
	return result != (kind & 1);
}

/* Beyond the range what wasm and C leave open is the nearest end. */
static uint64_t integer_of(double x, int kind)
{
	switch (kind) {
	case 0:  return (uint64_t)(x >= 0x1p31 ? INT32_MAX : x > -0x1p31 - 1 ? (int32_t)x : INT32_MIN);
	case 1:  return (uint64_t)(int32_t)(x >= 0x1p32 ? UINT32_MAX : x > 0 ? (uint32_t)x : 0);
	case 2:  return (uint64_t)(x >= 0x1p63 ? INT64_MAX : x >= -0x1p63 ? (int64_t)x : INT64_MIN);
	default: return x >= 0x1p64 ? UINT64_MAX : x > 0 ? (uint64_t)x : 0;
	}
}

#define OPERATION(name, real, member) \
	static void name(int d, int kind, int what, real a, real b, uint64_t x, real_register whole, int part) \
	{ \
		switch (what) { \
		case 0:	   r.f[d].member = a + b; break; \
		case 1:	   r.f[d].member = a - b; break; \
		case 2:	   r.f[d].member = a * b; break; \
		case 3:	   r.f[d].member = a / b; break; \
		case 4:	   r.f[d] = whole; break;       /* tcc only moves by it */ \
		case 20:   r.x[d] = kind == 2 ? a == b : kind == 1 ? a < b : a <= b; break; \
		case 24:   r.x[d] = integer_of((double)a, part); break; \
		case 26:   r.f[d].member = part == 0 ? (real)(int32_t)x : part == 1 ? (real)(uint32_t)x \
					 : part == 2 ? (real)(int64_t)x : (real)x; break; \
		case 28:   r.x[d] = sizeof(real) == WORD ? whole.bits : (uint64_t)(int32_t)whole.bits; break; \
		case 30:   r.f[d].bits = x; break; \
		} \
	}
OPERATION(operate, double, d)
OPERATION(operate_in_float, float, f)

static void calculate_real(uint32_t word)
{
	const int d = word >> 7 & 31, kind = word >> 12 & 7, what = word >> 27, part = word >> 20 & 31;
	const real_register a = r.f[word >> 15 & 31], b = r.f[part];
	const uint64_t x = r.x[word >> 15 & 31];
	if (what == 8 && (word >> 25 & 1))
		r.f[d].d = a.f;
	else if (what == 8)
		r.f[d].f = (float)a.d;
	else if (word >> 25 & 1)
		operate(d, kind, what, a.d, b.d, x, a, part);
	else
		operate_in_float(d, kind, what, a.f, b.f, x, a, part);
}

/* The instruction there; the address of the next */
static uint64_t carry_out(uint64_t at)
{
	const uint32_t word = *(const uint32_t *)(uintptr_t)at;
	const int d = word >> 7 & 31, kind = word >> 12 & 7;
	const bool other = word >> 30 & 1, products = word >> 25 & 1;
	const uint64_t a = r.x[word >> 15 & 31], b = r.x[word >> 20 & 31], near = (uint64_t)field(word, 20, 12);
	const uint64_t far = (uint64_t)(int32_t)(word & 0xfffff000), to = a + (uint64_t)(field(word, 25, 7) * 32 + d);
	uint64_t next = at + 4, x = r.x[d];
	switch (word & 127) {
	case 0x37: x = far; break;
	case 0x17: x = at + far; break;
	case 0x6f:
		x = next;
		next = at + (uint64_t)(field(word, 31, 1) * (1 << 20) + (word & 0xff000) + (word >> 9 & 0x800) +
				       (word >> 20 & 0x7fe));
		break;
	case 0x67: x = next; next = a + near; break;
	case 0x63:
		if (holds(kind, a, b))
			next = at + (uint64_t)(field(word, 31, 1) * 4096 + (word << 4 & 0x800) + (word >> 20 & 0x7e0) +
					       (word >> 7 & 0x1e));
		return next;
	case 0x03: x = load(a + near, kind); break;
	case 0x23: store(to, b, kind); return next;
	case 0x07: r.f[d].bits = load(a + near, kind); return next;
	case 0x27: store(to, r.f[word >> 20 & 31].bits, kind); return next;
	case 0x13: x = calculated(kind, kind == 5 && other, a, near); break;
	case 0x1b: x = calculated_in_32(kind, kind == 5 && other, (uint32_t)a, (uint32_t)near); break;
	case 0x33: x = products ? multiplied(kind, a, b) : calculated(kind, other, a, b); break;
	case 0x3b:
		x = products ? multiplied_in_32(kind, a, b)
			     : calculated_in_32(kind, other, (uint32_t)a, (uint32_t)b);
		break;
	case 0x53: calculate_real(word); return next;
	default:   abort();
	}
	r.x[d] = x;
	r.x[0] = 0;
	return next;
}

static void emulate(const void *function)
{
	uint64_t at = (uintptr_t)function;
	r.x[1] = 0;
	r.x[2] = (uintptr_t)(stack + STACK);
	while (at)
		at = at < OUTSIDE ? call_outside(at / WORD) : carry_out(at);
}

/* ---- the model's code ---- */

static const char *const function[] = { "place", "init", "set", "tune", "hold", "look", "steps", "probe", "time" };
enum { FUNCTIONS = sizeof function / sizeof *function, TIME = FUNCTIONS - 1 };
static void *at[FUNCTIONS];

/* One of the functions of plpage.h, of a whole number or a time; what it returns */
double call(int which, int number, double t);
double call(int which, int number, double t)
{
	r.x[10] = (uint64_t)number;
	r.f[10].d = t;
	emulate(at[which]);
	return which == TIME ? r.f[10].d : (double)(int64_t)r.x[10];
}

static void fail(void *context, const char *message)
{
	(void)context;
	fprintf(stderr, "plgen: error: the C of the model cannot be run here: %s\n", message);
	exit(1);
}

/* Of <float.h> */
static const char of_doubles[] = "#define FLT_EVAL_METHOD 0\n#define DBL_MANT_DIG 53\n#define DBL_MAX_EXP 1024\n"
				 "#define DBL_EPSILON 0x1p-52\n#define FLT_MANT_DIG 24\n#define FLT_MAX_EXP 128\n";

/* Headers are in the text already. */
static char *whole_text(const char *code)
{
	char *text = format("%s%s%s", texts[0].text, of_doubles, code);
	for (char *line = text; line; line = strchr(line, '\n')) {
		line += *line == '\n';
		if (strncmp(line, "#include", strlen("#include")) == 0)
			memcpy(line, "//", 2);
	}
	return text;
}

static void link_here(TCCState *tcc)
{
	for (uintptr_t i = 1; i < sizeof outside / sizeof *outside; i++)
		tcc_add_symbol(tcc, outside[i], (void *)(i * WORD));
	const int size = tcc_relocate(tcc, NULL);
	void *room = size < 0 ? NULL : need_memory(malloc((size_t)size));
	if (!room || tcc_relocate(tcc, room) < 0)
		fail(NULL, "it does not fit");
	for (int i = 0; i < FUNCTIONS; i++)
		at[i] = tcc_get_symbol(tcc, function[i]);
}

/* Nothing is written into the page: its engine calls what is here. */
char *wasm_of(const char *code, size_t *length)
{
	TCCState *tcc = need_memory(tcc_new());
	tcc_set_error_func(tcc, NULL, fail);
	tcc_set_options(tcc, "-nostdlib -nostdinc -w");
	*length = 0;
	if (tcc_set_output_type(tcc, TCC_OUTPUT_MEMORY) < 0 || tcc_compile_string(tcc, whole_text(code)) < 0)
		fail(NULL, "libtcc gives up");
	link_here(tcc);
	return ARRAY(char, 1);
}

/* ---- what there is no compiler or thread for ---- */

#ifdef __wasm__
struct native native_of(struct place at, const struct step *step, enum running_with with)
{
	(void)step, (void)with;
	error(at, "plgen itself tries steps; here a spec says its step and scheme",
	      "the step would have to be tried, which a page cannot");
}

int pthread_attr_init(pthread_attr_t *attributes) { return *attributes = 0; }
int pthread_attr_setstacksize(pthread_attr_t *attributes, size_t size) { return (void)attributes, (void)size, 0; }
int pthread_join(pthread_t thread, void **result) { return (void)thread, (void)result, 0; }
int pthread_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*work)(void *), void *context)
{
	(void)attributes;
	work(context);
	return *thread = 0;
}

/* As other libraries round it nearly always: that of this one is a bit off now and then. */
double hypot(double x, double y)
{
	return (double)sqrtl((long double)x * x + (long double)y * y);
}

int mprotect(void *address, size_t size, int protection) { return (void)address, (void)size, (void)protection, 0; }
#endif
