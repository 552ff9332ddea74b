/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An FMU's sources through the system's compiler, in a folder of their own, to the shared object that importers
 * load. */
#define _GNU_SOURCE     /* environ */
#include "command.h"

#include <errno.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <sys/wait.h>
#include <unistd.h>

static bool complain(const char *what, const char *why)
{
	fprintf(stderr, "plgen: error: %s%s%s\n", what, why ? ": " : "", why ? why : "");
	return false;
}

/* ---- the folder ---- */

static const char *inside(const char *folder, const char *name)
{
	return format("%s/%s", folder, name);
}

/* Of sources/fmi3.c its name in the folder; NULL: it is not compiled from */
static const char *source_name(const struct member *m)
{
	static const char sources[] = "sources/";
	return strncmp(m->name, sources, sizeof sources - 1) == 0 ? m->name + sizeof sources - 1 : NULL;
}

static bool write_member(const char *path, const struct member *m)
{
	FILE *f = fopen(path, "wb");
	if (!f)
		return false;
	bool written = fwrite(m->bytes, 1, m->length, f) == m->length;
	return (fclose(f) == 0) & written;
}

static bool write_sources(const struct fmu *fmu, const char *folder)
{
	for (int i = 0; i < fmu->archive.members; i++) {
		const struct member *m = &fmu->archive.member[i];
		if (source_name(m) && !write_member(inside(folder, source_name(m)), m))
			return complain(format("cannot write to '%s'", folder), strerror(errno));
	}
	return true;
}

static void remove_folder(const struct fmu *fmu, const char *folder, const char *object)
{
	for (int i = 0; i < fmu->archive.members; i++)
		if (source_name(&fmu->archive.member[i]))
			unlink(inside(folder, source_name(&fmu->archive.member[i])));
	unlink(object);
	rmdir(folder);
}

/* ---- the compiler ---- */

struct words {
	const char **word;              /* ends with NULL */
	size_t count;
};

static void add(struct words *w, const char *word)
{
	ENLARGE(w->word, w->count + 2);
	w->word[w->count++] = word;
	w->word[w->count] = NULL;
}

/* CC and CFLAGS are lists of words, as for make. */
static void add_words(struct words *w, const char *name, const char *otherwise)
{
	const char *text = getenv(name);
	char *rest, *words = format("%s", text && text[strspn(text, " \t\n")] ? text : otherwise);
	for (char *word = strtok_r(words, " \t\n", &rest); word; word = strtok_r(NULL, " \t\n", &rest))
		add(w, word);
}

static struct words command_of(const struct fmu *fmu, const char *headers, const char *folder, const char *object)
{
	struct words w = { 0 };
	add_words(&w, "CC", "cc");
	add(&w, "-std=c99");
	add(&w, "-O2");
	add_words(&w, "CFLAGS", "");
	add(&w, "-fPIC");
	add(&w, "-shared");
	add(&w, "-s");
	add(&w, "-fvisibility=hidden");         /* two FMUs in one program share nothing but what the standard names */
	add(&w, format("-DFMI%d_OVERRIDE_FUNCTION_PREFIX", fmu->version));
	if (headers) {
		add(&w, "-include");
		add(&w, format("%s/fmi%dFunctions.h", headers, fmu->version));
	}
	for (int i = 0; i < FMU_SOURCES; i++)
		add(&w, inside(folder, fmu->source[i]));
	add(&w, "-o");
	add(&w, object);
	add(&w, "-lm");
	return w;
}

static bool compile(const struct words *w)
{
	pid_t child;
	int status = 0;
	int error = posix_spawnp(&child, w->word[0], NULL, NULL, (char *const *)(uintptr_t)w->word, environ);
	while (!error && waitpid(child, &status, 0) < 0)
		error = errno == EINTR ? 0 : errno;
	if (error)
		return complain(format("cannot run '%s'", w->word[0]), strerror(error));
	if (status != 0)
		return complain(format("the compiler '%s' could not make the FMU's shared object", w->word[0]), NULL);
	return true;
}

/* ---- its place in the FMU ---- */

/* FMI 2.0.5, 2.3: linux64; FMI 3.0.2, 2.5.1.4: x86_64-linux */
static const char *platform(int version)
{
	struct utsname system;
	if (version == 2)
		return sizeof(void *) == 8 ? "linux64" : "linux32";
	return uname(&system) == 0 ? format("%s-linux", system.machine) : "x86_64-linux";
}

static bool add_object(struct fmu *fmu, const char *object)
{
	FILE *f = fopen(object, "rb");
	if (!f)
		return complain(format("cannot read '%s'", object), strerror(errno));
	char *bytes = NULL;
	size_t length = 0, got;
	do {
		ENLARGE(bytes, length + 65536);
		got = fread(bytes + length, 1, 65536, f);
		length += got;
	} while (got > 0);
	bool whole = !ferror(f);
	fclose(f);
	archive_add(&fmu->archive, format("binaries/%s/%s.so", platform(fmu->version), fmu->name), bytes, length);
	return whole || complain(format("cannot read '%s'", object), NULL);
}

bool add_binary(struct fmu *fmu, const char *headers)
{
	const char *place = getenv("TMPDIR");
	char *folder = format("%s/plgen.XXXXXX", place && *place ? place : "/tmp");
	if (!mkdtemp(folder))
		return complain(format("cannot make a folder '%s'", folder), strerror(errno));
	const char *object = format("%s/%s.so", folder, fmu->name);
	const struct words command = command_of(fmu, headers, folder, object);
	bool added = write_sources(fmu, folder) && compile(&command) && add_object(fmu, object);
	remove_folder(fmu, folder, object);
	return added;
}
