/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is asked for is kept and given back when the program ends. GMP, MPFR and MPFI free as they go; the generator's
 * own structures do not, so no stage needs to know who else still looks at them. Small blocks are cut from slabs, and
 * go back to a list of their size; the others are chunks of malloc, in one ring. What is held is counted, as are the
 * terms that were made: two budgets, looked at where the generator itself asks for memory, never inside GMP. They are
 * counts, so that a spec is within them on every machine or on none. */
#include "base/base.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <pthread.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

/* The last bytes of both are the size of the block that begins after them. */
struct chunk {
	_Alignas(max_align_t) struct chunk *before;
	struct chunk *after;
	size_t unused;
};
struct cell {                       /* of a slab */
	_Alignas(max_align_t) struct cell *next;        /* where it is free */
};
struct slab {
	_Alignas(max_align_t) struct slab *before;
};
_Static_assert(offsetof(struct chunk, unused) + sizeof(size_t) < sizeof(struct chunk), "there is room for the size");
_Static_assert(sizeof(struct cell *) + sizeof(size_t) <= sizeof(struct cell), "there is room for the size");

#ifdef __SANITIZE_ADDRESS__
enum { SMALL = 0 };                 /* so that every block is watched */
#else
enum { SMALL = 512 };               /* bytes of a block, at most, that a slab holds */
#endif
enum { CELL = sizeof(struct cell), KINDS = SMALL / CELL + 1, SLAB = 1 << 18 };

static struct chunk ring;
static struct slab *slabs;
static struct cell *free_cells[KINDS];   /* blocks of up to so many times CELL */
static char *unsplit, *end_of_slab;
static size_t held, terms;          /* bytes now; terms so far */
static bool over;                   /* a budget is spent, and that is being reported */

static _Noreturn void out_of_memory(void)
{
	fputs("plgen: error: out of memory\n", stderr);
	exit(1);
}

void *need_memory(void *block)
{
	if (!block)
		out_of_memory();
	return block;
}

static size_t *size_of(void *block)
{
	return (size_t *)block - 1;
}

double memory_used(void)
{
	return (double)held / LIMIT_BYTES;
}

static size_t kind_of(size_t size)
{
	return (size + CELL - 1) / CELL;
}

static void *cell_of_slab(size_t kind)
{
	size_t length = (kind + 1) * CELL;
	if ((size_t)(end_of_slab - unsplit) < length) {
		struct slab *slab = malloc(SLAB);
		if (!slab)
			out_of_memory();
		slab->before = slabs;
		slabs = slab;
		unsplit = (char *)(slab + 1);
		end_of_slab = (char *)slab + SLAB;
	}
	struct cell *cell = (struct cell *)unsplit;
	unsplit += length;
	return cell + 1;
}

static void *new_cell(size_t size)
{
	size_t kind = kind_of(size);
	struct cell *cell = free_cells[kind];
	if (!cell)
		return cell_of_slab(kind);
	free_cells[kind] = cell->next;
	return cell + 1;
}

static void link_chunk(struct chunk *chunk)
{
	chunk->before = &ring;
	chunk->after = ring.after;
	chunk->after->before = chunk;
	ring.after = chunk;
}

static void unlink_chunk(struct chunk *chunk)
{
	chunk->before->after = chunk->after;
	chunk->after->before = chunk->before;
}

static void *new_chunk(size_t size, bool zeroed)
{
	struct chunk *chunk = NULL;
	if (size <= SIZE_MAX - sizeof *chunk)       /* fresh pages are zero, and much of a large block stays so */
		chunk = zeroed ? calloc(1, sizeof *chunk + size) : malloc(sizeof *chunk + size);
	if (!chunk)
		out_of_memory();
	link_chunk(chunk);
	return chunk + 1;
}

static void *new_block(size_t size, bool zeroed)
{
	void *block = size <= SMALL ? new_cell(size) : new_chunk(size, zeroed);
	*size_of(block) = size;
	held += sizeof(struct chunk) + size;     /* however it is kept */
	return zeroed && size <= SMALL ? memset(block, 0, size) : block;
}

static void *ring_new(size_t size)
{
	return new_block(size, false);
}

static void give_back(void *block)
{
	size_t size = *size_of(block);
	held -= sizeof(struct chunk) + size;
	if (size <= SMALL) {
		struct cell *cell = (struct cell *)block - 1;
		cell->next = free_cells[kind_of(size)];
		free_cells[kind_of(size)] = cell;
	} else {
		unlink_chunk((struct chunk *)block - 1);
		free((struct chunk *)block - 1);
	}
}

static void *move_block(void *old, size_t size)
{
	size_t before = *size_of(old);
	void *block = ring_new(size);
	memcpy(block, old, before < size ? before : size);
	give_back(old);
	return block;
}

static void *ring_resize(void *old, size_t size)
{
	if (!old)
		return ring_new(size);
	size_t before = *size_of(old);
	if (before <= SMALL ? size > SMALL || kind_of(before) != kind_of(size) : size <= SMALL)
		return move_block(old, size);
	if (before > SMALL) {
		struct chunk *chunk = (struct chunk *)old - 1;
		unlink_chunk(chunk);
		chunk = size > SIZE_MAX - sizeof *chunk ? NULL : realloc(chunk, sizeof *chunk + size);
		if (!chunk)
			out_of_memory();
		link_chunk(chunk);
		old = chunk + 1;
	}
	held += size - before;
	*size_of(old) = size;
	return old;
}

static void *gmp_resize(void *old, size_t old_size, size_t size)
{
	(void)old_size;
	return ring_resize(old, size);
}

static void gmp_free(void *old, size_t size)
{
	(void)size;
	give_back(old);
}

void memory_open(void)
{
	ring.before = ring.after = &ring;
	mp_set_memory_functions(ring_new, gmp_resize, gmp_free);
}

void memory_close(void)
{
	mpfr_free_cache();
	for (struct chunk *chunk = ring.after, *after; chunk != &ring; chunk = after) {
		after = chunk->after;
		free(chunk);
	}
	ring.before = ring.after = &ring;
	for (struct slab *before; slabs; slabs = before) {
		before = slabs->before;
		free(slabs);
	}
	memset(free_cells, 0, sizeof free_cells);
	unsplit = end_of_slab = NULL;
}

static void stop(const char *message)
{
	fprintf(stderr, "plgen: error: %s\n", message);
	exit(1);
}

static void (*spent)(const char *message) = stop;

void memory_on_limit(void (*report)(const char *message))
{
	spent = report;
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
	return new_block(count * size, true);
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
	char most[256];                         /* of those that there are */
	int length = vsnprintf(most, sizeof most, fmt, args);
	check_bytes((size_t)length + 1);
	char *text = ring_new((size_t)length + 1);
	if ((size_t)length < sizeof most)
		memcpy(text, most, (size_t)length + 1);
	else
		vsnprintf(text, (size_t)length + 1, fmt, again);
	va_end(again);
	va_end(args);
	return text;
}

const char *name_list(int count, const char *const *name)
{
	const char *list = count > 0 ? name[0] : "";
	for (int i = 1; i < count; i++)
		list = format("%s, %s", list, name[i]);
	return list;
}

int place_among(int count, const char *const *name, const char *text, size_t length)
{
	for (int i = 0; i < count; i++)
		if (strlen(name[i]) == length && memcmp(name[i], text, length) == 0)
			return i;
	return -1;
}

void rationals_free(mpq_t *q, size_t count)
{
	for (size_t i = 0; i < count; i++)
		mpq_clear(q[i]);
	discard(q);
}

size_t block_size(void *block)
{
	return block ? *size_of(block) : 0;
}

void clear_rationals(mpq_t **q)
{
	for (size_t i = 0; i < block_size(*q) / sizeof **q; i++)
		mpq_clear((*q)[i]);
	discard(*q);
}

void clear_integers(mpz_t **z)
{
	for (size_t i = 0; i < block_size(*z) / sizeof **z; i++)
		mpz_clear((*z)[i]);
	discard(*z);
}

void clear_reals(mpfr_t **x)
{
	for (size_t i = 0; i < block_size(*x) / sizeof **x; i++)
		mpfr_clear((*x)[i]);
	discard(*x);
}

void clear_intervals(mpfi_t **x)
{
	for (size_t i = 0; i < block_size(*x) / sizeof **x; i++)
		mpfi_clear((*x)[i]);
	discard(*x);
}

void clear_scratch(void *block)
{
	void *scratch;
	memcpy(&scratch, block, sizeof scratch);
	discard(scratch);
}

int *numbers_up_to(int count)
{
	int *number = ARRAY(int, count);
	for (int i = 0; i < count; i++)
		number[i] = i;
	return number;
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

mpz_t *integers(size_t count)
{
	mpz_t *z = ARRAY(mpz_t, count);
	for (size_t i = 0; i < count; i++)
		mpz_init(z[i]);
	return z;
}

mpfr_t *reals(size_t count, mpfr_prec_t bits)
{
	mpfr_t *x = ARRAY(mpfr_t, count);
	for (size_t i = 0; i < count; i++) {
		mpfr_init2(x[i], bits);
		mpfr_set_zero(x[i], 1);
	}
	return x;
}

mpfi_t *enclosures(size_t count, mpfr_prec_t bits)
{
	mpfi_t *x = ARRAY(mpfi_t, count);
	for (size_t i = 0; i < count; i++) {
		mpfi_init2(x[i], bits);
		mpfi_set_ui(x[i], 0);
	}
	return x;
}

mpq_t *rationals_copied(size_t count, const mpq_t *q)
{
	mpq_t *copy = rationals(count);
	for (size_t i = 0; i < count; i++)
		mpq_set(copy[i], q[i]);
	return copy;
}

bool rationals_equal(size_t count, const mpq_t *a, const mpq_t *b)
{
	for (size_t i = 0; i < count; i++)
		if (!mpq_equal(a[i], b[i]))
			return false;
	return true;
}

bool rationals_zero(size_t count, const mpq_t *q)
{
	for (size_t i = 0; i < count; i++)
		if (mpq_sgn(q[i]) != 0)
			return false;
	return true;
}

/* ---- the stack ---- */

/* Of the thread that works; of memory that is not given back, as what is asked for again would be cleared again */
enum { STACK_SIZE = 96 << 20, KEPT = 256 << 20 };

/* The walks over expressions recurse, LIMIT_DEPTH deep at most; what stack a program is started with differs from
 * system to system, and a limit of the user's cannot be raised from here. So all work is done on a stack of its own, of
 * pages that cost nothing until they are used. */
bool run_deep(void *(*work)(void *), void *context)
{
	pthread_attr_t attributes;
	pthread_t thread;
#ifdef M_ARENA_MAX
	mallopt(M_ARENA_MAX, 1);        /* one thread works: it needs no heap of its own */
#endif
#ifdef M_TRIM_THRESHOLD
	mallopt(M_TRIM_THRESHOLD, KEPT);
	mallopt(M_MMAP_THRESHOLD, KEPT);
#endif
	return pthread_attr_init(&attributes) == 0 && pthread_attr_setstacksize(&attributes, STACK_SIZE) == 0 &&
	       pthread_create(&thread, &attributes, work, context) == 0 && pthread_join(thread, NULL) == 0;
}
