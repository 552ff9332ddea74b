/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Zip (APPNOTE 6.3, sections 4.3 and 4.4): members stored as they are, of the first day that its dates know. FMI asks
 * for no more, and what is not compressed is the same bytes whatever library is there. */
#include "fmu/fmu.h"

#include <string.h>

void archive_add(struct archive *a, const char *name, const char *bytes, size_t length)
{
	*MORE(a->member, a->members) = (struct member){ name, bytes, length };
}

/* Little-endian, whatever the machine */
static void put_number(FILE *to, unsigned long value, int bytes)
{
	for (int i = 0; i < bytes; i++)
		fputc((int)(value >> 8 * i & 0xff), to);
}

/* The polynomial 0xedb88320, its bits reversed, as zip takes it */
static unsigned long checksum(const char *bytes, size_t length)
{
	unsigned long sum = 0xffffffff;
	for (size_t i = 0; i < length; i++) {
		sum ^= (unsigned char)bytes[i];
		for (int bit = 0; bit < 8; bit++)
			sum = sum >> 1 ^ (sum & 1 ? 0xedb88320 : 0);
	}
	return sum ^ 0xffffffff;
}

/* What the two headers of a member have in common */
static void put_shape(FILE *to, const struct member *m)
{
	enum { VERSION = 10, STORED = 0, MIDNIGHT = 0, FIRST_DAY = 1 << 5 | 1 }; /* 1 January 1980 */
	put_number(to, VERSION, 2);
	put_number(to, 0, 2);
	put_number(to, STORED, 2);
	put_number(to, MIDNIGHT, 2);
	put_number(to, FIRST_DAY, 2);
	put_number(to, checksum(m->bytes, m->length), 4);
	put_number(to, m->length, 4);
	put_number(to, m->length, 4);
	put_number(to, strlen(m->name), 2);
	put_number(to, 0, 2);
}

static size_t put_member(FILE *to, const struct member *m)
{
	put_number(to, 0x04034b50, 4);
	put_shape(to, m);
	fputs(m->name, to);
	fwrite(m->bytes, 1, m->length, to);
	return 30 + strlen(m->name) + m->length;
}

static size_t put_entry(FILE *to, const struct member *m, size_t offset)
{
	enum { UNIX = 3 << 8 | 20 };
	put_number(to, 0x02014b50, 4);
	put_number(to, UNIX, 2);
	put_shape(to, m);
	put_number(to, 0, 2);                   /* comment, disk, kind of text */
	put_number(to, 0, 2);
	put_number(to, 0, 2);
	put_number(to, 0100644UL << 16, 4);
	put_number(to, offset, 4);
	fputs(m->name, to);
	return 46 + strlen(m->name);
}

void archive_write(FILE *to, const struct archive *a)
{
	size_t *offset = ARRAY(size_t, a->members), end = 0, size = 0;
	for (int i = 0; i < a->members; i++) {
		offset[i] = end;
		end += put_member(to, &a->member[i]);
	}
	for (int i = 0; i < a->members; i++)
		size += put_entry(to, &a->member[i], offset[i]);
	put_number(to, 0x06054b50, 4);
	put_number(to, 0, 4);
	put_number(to, (unsigned long)a->members, 2);
	put_number(to, (unsigned long)a->members, 2);
	put_number(to, size, 4);
	put_number(to, end, 4);
	put_number(to, 0, 2);
}
