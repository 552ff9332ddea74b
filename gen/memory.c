/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every block is kept in one ring and given back when the program ends. GMP, MPFR and MPFI free as they go; the
 * generator's own structures do not, so no stage needs to know who else still looks at them. */
#include "plgen.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

union block {
	struct { union block *before, *after; } ring;
	max_align_t align;
};

static union block ring;

static void link_block(union block *block)
{
	block->ring.before = &ring;
	block->ring.after = ring.ring.after;
	block->ring.after->ring.before = block;
	ring.ring.after = block;
}

static void unlink_block(union block *block)
{
	block->ring.before->ring.after = block->ring.after;
	block->ring.after->ring.before = block->ring.before;
}

static _Noreturn void out_of_memory(void)
{
	fputs("plgen: error: out of memory\n", stderr);
	exit(1);
}

static void *ring_new(size_t size)
{
	union block *block = size > SIZE_MAX - sizeof *block ? NULL : malloc(sizeof *block + size);
	if (!block)
		out_of_memory();
	link_block(block);
	return block + 1;
}

static void *ring_resize(void *old, size_t size)
{
	if (!old)
		return ring_new(size);
	union block *block = (union block *)old - 1;
	unlink_block(block);
	block = size > SIZE_MAX - sizeof *block ? NULL : realloc(block, sizeof *block + size);
	if (!block)
		out_of_memory();
	link_block(block);
	return block + 1;
}

static void *gmp_resize(void *old, size_t old_size, size_t size)
{
	(void)old_size;
	return ring_resize(old, size);
}

static void gmp_free(void *old, size_t size)
{
	(void)size;
	unlink_block((union block *)old - 1);
	free((union block *)old - 1);
}

void memory_open(void)
{
	ring.ring.before = ring.ring.after = &ring;
	mp_set_memory_functions(ring_new, gmp_resize, gmp_free);
}

void memory_close(void)
{
	mpfr_free_cache();
	for (union block *block = ring.ring.after, *after; block != &ring; block = after) {
		after = block->ring.after;
		free(block);
	}
	ring.ring.before = ring.ring.after = &ring;
}

void *allocate(size_t count, size_t size)
{
	if (size && count > SIZE_MAX / size)
		out_of_memory();
	return memset(ring_new(count * size), 0, count * size);
}

void *enlarge(void *block, size_t count, size_t size)
{
	if (size && count > SIZE_MAX / size)
		out_of_memory();
	return ring_resize(block, count * size);
}

char *format(const char *fmt, ...)
{
	va_list args, again;
	va_start(args, fmt);
	va_copy(again, args);
	int length = vsnprintf(NULL, 0, fmt, args);
	char *text = ring_new((size_t)length + 1);
	vsnprintf(text, (size_t)length + 1, fmt, again);
	va_end(again);
	va_end(args);
	return text;
}

mpq_t *rationals(size_t count)
{
	mpq_t *q = ARRAY(mpq_t, count);
	for (size_t i = 0; i < count; i++)
		mpq_init(q[i]);
	return q;
}
