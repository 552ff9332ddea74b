/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loaded before the C library: the FAIL_AT-th call of the kind FAIL_KIND fails, memory or write, and is counted in the
 * file FAIL_COUNT. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *old, size_t size);

static long count;

/* Is it this call's turn? */
static bool fails(const char *kind)
{
	const char *wanted = getenv("FAIL_KIND"), *at = getenv("FAIL_AT");
	return wanted && at && strcmp(wanted, kind) == 0 && ++count == atol(at);
}

__attribute__((destructor)) static void tell(void)
{
	char text[32];
	const char *path = getenv("FAIL_COUNT");
	ssize_t (*plain)(int, const void *, size_t);
	void *found = dlsym(RTLD_NEXT, "write");
	int to = path ? open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600) : -1;
	memcpy(&plain, &found, sizeof plain);
	if (to >= 0)
		plain(to, text, (size_t)snprintf(text, sizeof text, "%ld\n", count));
}

static bool no_memory(void)
{
	if (!fails("memory"))
		return false;
	errno = ENOMEM;
	return true;
}

void *malloc(size_t size)
{
	return no_memory() ? NULL : __libc_malloc(size);
}

void *calloc(size_t n, size_t size)
{
	return no_memory() ? NULL : __libc_calloc(n, size);
}

void *realloc(void *old, size_t size)
{
	return no_memory() ? NULL : __libc_realloc(old, size);
}

#define NEXT(result, name, parameters) \
	result (*next) parameters; \
	void *found = dlsym(RTLD_NEXT, name); \
	memcpy(&next, &found, sizeof next)

ssize_t write(int to, const void *bytes, size_t length)
{
	NEXT(ssize_t, "write", (int, const void *, size_t));
	if (to > 2 && fails("write")) {
		errno = ENOSPC;
		return -1;
	}
	return next(to, bytes, length > 1000 && to > 2 ? 1000 : length);    /* in parts, as it may */
}

int close(int descriptor)
{
	NEXT(int, "close", (int));
	int status = next(descriptor);
	if (descriptor > 2 && fails("write")) {
		errno = EIO;
		return -1;
	}
	return status;
}

int rename(const char *from, const char *to)
{
	NEXT(int, "rename", (const char *, const char *));
	if (fails("write")) {
		errno = EROFS;
		return -1;
	}
	return next(from, to);
}

int mkstemp(char *name)
{
	NEXT(int, "mkstemp", (char *));
	if (fails("write")) {
		errno = EMFILE;
		return -1;
	}
	return next(name);
}

int fchmod(int descriptor, mode_t mode)
{
	NEXT(int, "fchmod", (int, mode_t));
	if (fails("write")) {
		errno = EPERM;
		return -1;
	}
	return next(descriptor, mode);
}
