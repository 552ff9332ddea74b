/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every chunk is kept in one ring and given back when the program ends. GMP, MPFR and MPFI free as they go; the
 * generator's own structures do not, so no stage needs to know who else still looks at them. What is held is counted,
 * as are the terms that were made: two budgets, looked at where the generator itself asks for memory, never inside GMP.
 * They are counts, so that a spec is within them on every machine or on none. */
#include "base/base.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

union chunk {
	struct { union chunk *before, *after; size_t size; } ring;
	max_align_t align;
};

static union chunk ring;
static size_t held, terms;          /* bytes now; terms so far */
static bool over;                   /* a budget is spent, and that is being told */

static void link_block(union chunk *chunk, size_t size)
{
	chunk->ring.size = size;
	held += size;
	chunk->ring.before = &ring;
	chunk->ring.after = ring.ring.after;
	chunk->ring.after->ring.before = chunk;
	ring.ring.after = chunk;
}

static void unlink_block(union chunk *chunk)
{
	held -= chunk->ring.size;
	chunk->ring.before->ring.after = chunk->ring.after;
	chunk->ring.after->ring.before = chunk->ring.before;
}

static _Noreturn void out_of_memory(void)
{
	fputs("plgen: error: out of memory\n", stderr);
	exit(1);
}

static void *ring_new(size_t size)
{
	union chunk *chunk = size > SIZE_MAX - sizeof *chunk ? NULL : malloc(sizeof *chunk + size);
	if (!chunk)
		out_of_memory();
	link_block(chunk, sizeof *chunk + size);
	return chunk + 1;
}

static void *ring_resize(void *old, size_t size)
{
	if (!old)
		return ring_new(size);
	union chunk *chunk = (union chunk *)old - 1;
	unlink_block(chunk);
	chunk = size > SIZE_MAX - sizeof *chunk ? NULL : realloc(chunk, sizeof *chunk + size);
	if (!chunk)
		out_of_memory();
	link_block(chunk, sizeof *chunk + size);
	return chunk + 1;
}

static void *gmp_resize(void *old, size_t old_size, size_t size)
{
	(void)old_size;
	return ring_resize(old, size);
}

static void gmp_free(void *old, size_t size)
{
	(void)size;
	unlink_block((union chunk *)old - 1);
	free((union chunk *)old - 1);
}

void memory_open(void)
{
	ring.ring.before = ring.ring.after = &ring;
	mp_set_memory_functions(ring_new, gmp_resize, gmp_free);
}

void memory_close(void)
{
	mpfr_free_cache();
	for (union chunk *chunk = ring.ring.after, *after; chunk != &ring; chunk = after) {
		after = chunk->ring.after;
		free(chunk);
	}
	ring.ring.before = ring.ring.after = &ring;
}

static void stop(const char *message)
{
	fprintf(stderr, "plgen: error: %s\n", message);
	exit(1);
}

static void (*spent)(const char *message) = stop;

void memory_on_limit(void (*tell)(const char *message))
{
	spent = tell;
}

/* Before `size` more are asked for */
static void check_bytes(size_t size)
{
	if (over || (held <= LIMIT_BYTES && size <= LIMIT_BYTES - held))
		return;
	over = true;
	spent(format("this takes more memory than the limit of %d bytes", LIMIT_BYTES));
}

void spend_terms(size_t count)
{
	terms += count;
	if (terms <= LIMIT_TERMS || over)
		return;
	over = true;
	spent(format("multiplied out, this takes more terms than the limit of %d", LIMIT_TERMS));
}

void *allocate(size_t count, size_t size)
{
	if (size && count > SIZE_MAX / size)
		out_of_memory();
	check_bytes(count * size);
	return memset(ring_new(count * size), 0, count * size);
}

void *enlarge(void *chunk, size_t count, size_t size)
{
	if (size && count > SIZE_MAX / size)
		out_of_memory();
	check_bytes(chunk ? 0 : count * size);
	return ring_resize(chunk, count * size);
}

void discard(void *chunk)
{
	if (chunk)
		gmp_free(chunk, 0);
}

char *format(const char *fmt, ...)
{
	va_list args, again;
	va_start(args, fmt);
	va_copy(again, args);
	int length = vsnprintf(NULL, 0, fmt, args);
	check_bytes((size_t)length + 1);
	char *text = ring_new((size_t)length + 1);
	vsnprintf(text, (size_t)length + 1, fmt, again);
	va_end(again);
	va_end(args);
	return text;
}

void rationals_free(mpq_t *q, size_t count)
{
	for (size_t i = 0; i < count; i++)
		mpq_clear(q[i]);
	discard(q);
}

mpq_t *rationals(size_t count)
{
	enum { DENOMINATOR = 64 };      /* bytes of that of 0/1 */
	check_bytes(count > SIZE_MAX / DENOMINATOR ? SIZE_MAX : count * DENOMINATOR);
	mpq_t *q = ARRAY(mpq_t, count);
	for (size_t i = 0; i < count; i++)
		mpq_init(q[i]);
	return q;
}
