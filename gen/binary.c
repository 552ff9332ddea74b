/* SPDX-License-Identifier: GPL-3.0-or-later */
/* C through a compiler, in a folder of its own: an FMU's sources to the shared object that importers load, a model to
 * the WebAssembly of its page. */
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

static const char *new_folder(void)
{
	const char *place = getenv("TMPDIR");
	char *folder = format("%s/plgen.XXXXXX", place && *place ? place : "/tmp");
	if (mkdtemp(folder))
		return folder;
	complain(format("cannot make a folder '%s'", folder), strerror(errno));
	return NULL;
}

static char *read_bytes(const char *path, size_t *length)
{
	FILE *f = fopen(path, "rb");
	char *bytes = NULL;
	size_t got = 1;
	for (*length = 0; f && got > 0; *length += got) {
		ENLARGE(bytes, *length + 65536);
		got = fread(bytes + *length, 1, 65536, f);
	}
	const bool whole = f && !ferror(f);
	if (!whole)
		complain(format("cannot read '%s'", path), strerror(errno));
	if (f)
		fclose(f);
	return whole ? bytes : NULL;
}

/* Of sources/fmi3.c its name in the folder; NULL: it is not compiled from */
static const char *source_name(const struct member *m)
{
	static const char sources[] = "sources/";
	return strncmp(m->name, sources, sizeof sources - 1) == 0 ? m->name + sizeof sources - 1 : NULL;
}

static bool write_bytes(const char *path, const char *bytes, size_t length)
{
	FILE *f = fopen(path, "wb");
	if (!f)
		return false;
	bool written = fwrite(bytes, 1, length, f) == length;
	return (fclose(f) == 0) & written;
}

static bool write_sources(const struct fmu *fmu, const char *folder)
{
	for (int i = 0; i < fmu->archive.members; i++) {
		const struct member *m = &fmu->archive.member[i];
		if (source_name(m) && !write_bytes(inside(folder, source_name(m)), m->bytes, m->length))
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

/* `made`: what it makes; `advice` follows where that fails, NULL: none */
static bool compile(const struct words *w, const char *made, const char *advice)
{
	pid_t child;
	int status = 0;
	int error = posix_spawnp(&child, w->word[0], NULL, NULL, (char *const *)(uintptr_t)w->word, environ);
	while (!error && waitpid(child, &status, 0) < 0)
		error = errno == EINTR ? 0 : errno;
	if (!error && status == 0)
		return true;
	if (error)
		complain(format("cannot run '%s'", w->word[0]), strerror(error));
	else
		complain(format("the compiler '%s' could not make %s", w->word[0], made), NULL);
	if (advice)
		fprintf(stderr, "note: %s\n", advice);
	return false;
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
	size_t length;
	const char *bytes = read_bytes(object, &length);
	if (bytes)
		archive_add(&fmu->archive, format("binaries/%s/%s.so", platform(fmu->version), fmu->name), bytes,
			    length);
	return bytes;
}

bool add_binary(struct fmu *fmu, const char *headers)
{
	const char *folder = new_folder();
	if (!folder)
		return false;
	const char *object = format("%s/%s.so", folder, fmu->name);
	const struct words command = command_of(fmu, headers, folder, object);
	bool added = write_sources(fmu, folder) && compile(&command, "the FMU's shared object", NULL) &&
		     add_object(fmu, object);
	remove_folder(fmu, folder, object);
	return added;
}

/* ---- WebAssembly ---- */

/* Every function that the page calls is exported in the C. Sums stay as they are written; the stack lies below the
 * data, so that one that is too deep ends the run and spoils nothing. Without -msimd128, as clang 14 then makes wrong
 * numbers of two_masses. */
static struct words wasm_command(const char *source, const char *object)
{
	static const char *const flags[] = {
		"--target=wasm32", "-std=c99", "-Os", "-w", "-ffp-contract=off", "-ffreestanding", "-nostdlib",
		"-mbulk-memory", "-fvisibility=hidden", "-Wl,--no-entry", "-Wl,--strip-all",
		"-Wl,--stack-first", "-Wl,-z,stack-size=4194304", "-o"
	};
	struct words w = { 0 };
	add_words(&w, "PLGEN_CLANG", "clang");
	for (size_t i = 0; i < sizeof flags / sizeof *flags; i++)
		add(&w, flags[i]);
	add(&w, object);
	add(&w, source);
	return w;
}

/* The object, compressed */
static char *gzipped(const char *object, size_t *length)
{
	struct words w = { 0 };
	add(&w, "gzip");
	add(&w, "-9n");
	add(&w, object);
	const char *shorter = format("%s.gz", object);
	char *bytes = compile(&w, "the page's WebAssembly", NULL) ? read_bytes(shorter, length) : NULL;
	unlink(shorter);
	return bytes;
}

char *wasm_of(const char *code, size_t *length)
{
	const char *folder = new_folder();
	if (!folder)
		return NULL;
	const char *source = inside(folder, "page.c"), *object = inside(folder, "page.wasm");
	const struct words command = wasm_command(source, object);
	char *bytes = NULL;
	if (!write_bytes(source, code, strlen(code)))
		complain(format("cannot write to '%s'", folder), strerror(errno));
	else if (compile(&command, "the page's WebAssembly",
			 "it takes clang and wasm-ld, Debian's packages clang and lld; PLGEN_CLANG names a clang"))
		bytes = gzipped(object, length);
	unlink(source);
	unlink(object);
	rmdir(folder);
	return bytes;
}
