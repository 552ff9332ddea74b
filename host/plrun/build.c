/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From a spec to a shared object in the cache. */
#define _GNU_SOURCE
#include "plrun.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

struct toolchain {
	const char *plgen;
	const char **compiler;          /* its words and flags, NULL-terminated */
	size_t compiler_words;
	const char *wide;               /* a flag for lanes as wide as this machine's; NULL: the compiler's own */
	const char *runtime;            /* the folder of plrt.h */
	const char **source;            /* the .c files there */
	size_t sources;
	struct timespec newest;         /* of the runtime's files */
	const char *archive;            /* of the runtime, compiled with plrun; NULL: there is none of these files */
	struct hash key;                /* of all this */
};

/* ---- keys and the cache ---- */

void hash_begin(struct hash *h)
{
	h->value = (unsigned __int128)0x6c62272e07bb0142 << 64 | 0x62b821756295c58d;
}

void hash_bytes(struct hash *h, const void *bytes, size_t length)
{
	const unsigned __int128 prime = (unsigned __int128)1 << 88 | 0x13b;
	const unsigned char *byte = bytes;
	for (size_t i = 0; i < length; i++)
		h->value = (h->value ^ byte[i]) * prime;
}

void hash_text(struct hash *h, const char *text)
{
	hash_bytes(h, text, strlen(text) + 1);
}

char *hash_name(const struct hash *h)
{
	return format("%016llx%016llx", (unsigned long long)(h->value >> 64), (unsigned long long)h->value);
}

char *read_whole(const char *path, size_t *length)
{
	FILE *f = strcmp(path, "-") == 0 ? stdin : fopen(path, "rbe");
	char *text = NULL;
	size_t room = 0, got;
	*length = 0;
	if (!f)
		return NULL;
	do {
		if (room - *length < 4096)
			text = need(realloc(text, room = room ? 2 * room : 65536));
		got = fread(text + *length, 1, room - *length - 1, f);
		*length += got;
	} while (got);
	int error = ferror(f) ? errno ? errno : EIO : 0;
	if (f != stdin)
		fclose(f);
	text[*length] = 0;
	errno = error;
	return error ? NULL : text;
}

static void make_folders(char *path)
{
	for (char *slash = path + 1; ; slash++) {
		slash = strchrnul(slash, '/');
		char kept = *slash;
		*slash = 0;
		if (mkdir(path, 0777) != 0 && errno != EEXIST)
			fail(WRONG_DATA, format("cannot make the folder '%s': %s (XDG_CACHE_HOME names another place)",
						path, strerror(errno)));
		*slash = kept;
		if (!kept)
			return;
	}
}

const char *cache_folder(void)
{
	static char *folder;
	const char *cache = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
	if (folder)
		return folder;
	if (cache && *cache == '/')
		folder = format("%s/plgen", cache);
	else if (home && *home == '/')
		folder = format("%s/.cache/plgen", home);
	else
		fail(WRONG_DATA, "neither XDG_CACHE_HOME nor HOME says where to keep what is compiled");
	make_folders(folder);
	return folder;
}

/* ---- what there is to build with ---- */

static void add_word(struct toolchain *t, const char *word)
{
	t->compiler = need(reallocarray(t->compiler, t->compiler_words + 2, sizeof *t->compiler));
	t->compiler[t->compiler_words++] = word;
	t->compiler[t->compiler_words] = NULL;
}

/* The words of the environment's `name`, or of `otherwise`; a path to a program is one, blanks or not */
static void add_words(struct toolchain *t, const char *name, const char *otherwise)
{
	const char *text = getenv(name);
	bool said = text && text[strspn(text, " \t\n")];
	char *words = format("%s", said ? text : otherwise), *rest;
	if (strchr(words, '/') && access(words, X_OK) == 0) {
		add_word(t, words);
		return;
	}
	for (char *word = strtok_r(words, " \t\n", &rest); word; word = strtok_r(NULL, " \t\n", &rest))
		add_word(t, word);
}

static const char *find_plgen(void)
{
	const char *named = getenv("PLGEN"), *folder = folder_of_program();
	if (named && *named)
		return named;
	char *beside = folder ? format("%s/plgen", folder) : NULL;
	if (beside && access(beside, X_OK) == 0)
		return beside;
	char *found = find_in_path("plgen");
	if (!found)
		fail(WRONG_DATA, "there is no plgen beside plrun, nor in PATH; PLGEN names one");
	return found;
}

/* And the archive that belongs to it, there or not */
static void find_runtime(struct toolchain *t)
{
	const char *folder = folder_of_program(), *named = getenv("PLGEN_RUNTIME");
	const char *place[][2] = {
		{ named && *named ? format("%s", named) : NULL, NULL },
		{ folder ? format("%s/../share/plgen/runtime", folder) : NULL,
		  folder ? format("%s/" PLRUN_ARCHIVE_FROM_BIN, folder) : NULL },
		{ folder ? format("%s/../runtime", folder) : NULL, folder ? format("%s/libplrt.a", folder) : NULL },
		{ PLRUN_RUNTIME, PLRUN_ARCHIVE },
		{ PLRUN_SOURCE_RUNTIME, PLRUN_BUILD_ARCHIVE }
	};
	for (size_t i = 0; i < sizeof place / sizeof *place; i++)
		if (place[i][0] && access(format("%s/plrt.h", place[i][0]), R_OK) == 0) {
			t->runtime = place[i][0];
			t->archive = place[i][1];
			return;
		}
	fail(WRONG_DATA, "the runtime, plrt.h, is not there; PLGEN_RUNTIME names its folder");
}

static bool is_later(struct timespec a, struct timespec b)
{
	return a.tv_sec > b.tv_sec || (a.tv_sec == b.tv_sec && a.tv_nsec > b.tv_nsec);
}

static int by_name(const void *a, const void *b)
{
	return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* Every .c and .h of the runtime counts for the key; its .c are what is compiled. */
static void read_runtime(struct toolchain *t)
{
	DIR *folder = opendir(t->runtime);
	const char **name = NULL;
	size_t names = 0, room = 0, length;
	if (!folder)
		fail(WRONG_DATA, format("cannot read '%s': %s", t->runtime, strerror(errno)));
	for (struct dirent *entry; (entry = readdir(folder));) {
		size_t end = strlen(entry->d_name);
		if (end < 3 || (strcmp(entry->d_name + end - 2, ".c") && strcmp(entry->d_name + end - 2, ".h")))
			continue;
		name = grown(name, names, &room, sizeof *name);
		name[names++] = format("%s/%s", t->runtime, entry->d_name);
	}
	closedir(folder);
	qsort(name, names, sizeof *name, by_name);
	t->source = need(calloc(names + 1, sizeof *t->source));
	for (size_t i = 0; i < names; i++) {
		struct stat about;
		char *text = read_whole(name[i], &length);
		if (!text || stat(name[i], &about) != 0)
			fail(WRONG_DATA, format("cannot read '%s': %s", name[i], strerror(errno)));
		t->newest = is_later(about.st_mtim, t->newest) ? about.st_mtim : t->newest;
		hash_text(&t->key, strrchr(name[i], '/'));
		hash_bytes(&t->key, text, length + 1);
		free(text);
		if (name[i][strlen(name[i]) - 1] == 'c')
			t->source[t->sources++] = name[i];
	}
	free(name);
}

static bool asks_for_flags(void)
{
	const char *flags = getenv("CFLAGS");
	return flags && flags[strspn(flags, " \t\n")];
}

/* Sums over wider lanes have the same bits, which is why no journal knows of them. */
static const char *flag_for_lanes(const char *compiler)
{
	const char *name = strrchr(compiler, '/') + 1;
	if (asks_for_flags() || !(strstr(name, "gcc") || strstr(name, "clang") || strstr(name, "ccache")))
		return NULL;
#if defined(__x86_64__) && defined(__GNUC__)
	return __builtin_cpu_supports("avx512f") ? "-mavx512f" : __builtin_cpu_supports("avx2") ? "-mavx2" : NULL;
#else
	return NULL;
#endif
}

/* A compiler is its words, and of the file of the first its place, size and time: another version is another one. */
static void read_compiler(struct toolchain *t)
{
	struct stat about;
	add_words(t, "CC", "cc");
	char *file = find_in_path(t->compiler[0]), *real = file ? realpath(file, NULL) : NULL;
	if (!real || stat(real, &about) != 0)
		fail(WRONG_DATA, format("there is no compiler '%s'; CC names another", t->compiler[0]));
	hash_text(&t->key, real);
	hash_bytes(&t->key, &about.st_size, sizeof about.st_size);
	hash_bytes(&t->key, &about.st_mtim, sizeof about.st_mtim);
	t->wide = flag_for_lanes(real);
	add_word(t, "-O2");
	add_word(t, "-fPIC");
	add_word(t, "-w");
	add_words(t, "CFLAGS", "");
	for (size_t i = 0; i < t->compiler_words; i++)
		hash_text(&t->key, t->compiler[i]);
}

/* The archive serves where it is not older than what it is made of, and no flags ask for another. */
static void check_archive(struct toolchain *t)
{
	struct stat about;
	if (!t->archive || asks_for_flags() || access(t->archive, R_OK) != 0 ||
	    stat(t->archive, &about) != 0 || is_later(t->newest, about.st_mtim)) {
		t->archive = NULL;
		return;
	}
	hash_bytes(&t->key, &about.st_size, sizeof about.st_size);
	hash_bytes(&t->key, &about.st_mtim, sizeof about.st_mtim);
}

struct toolchain *find_tools(void)
{
	struct toolchain *t = need(calloc(1, sizeof *t));
	hash_begin(&t->key);
	hash_text(&t->key, "plrun " PLRUN_VERSION);
	t->plgen = find_plgen();
	find_runtime(t);
	read_runtime(t);
	read_compiler(t);
	check_archive(t);
	return t;
}

const char *plgen_of(const struct toolchain *t)
{
	return t->plgen;
}

const char *runtime_of(const struct toolchain *t)
{
	return t->runtime;
}

void hash_tools(const struct toolchain *t, struct hash *h)
{
	hash_bytes(h, &t->key.value, sizeof t->key.value);
}

/* ---- from a spec to C ---- */

/* What follows `mark` in the C, up to one of `ends`; NULL: it is not there */
static char *text_behind(const char *c, const char *mark, const char *ends)
{
	const char *from = strstr(c, mark);
	if (!from)
		return NULL;
	from += strlen(mark);
	return need(strndup(from, strcspn(from, ends)));
}

/* NAME_param_names[] = {"k", "c"}; */
static char **names_of_tunables(const char *c, const char *name)
{
	char *list = text_behind(c, format(" %s_param_names[] = {", name), "}"), *rest;
	char **names = need(calloc(1, sizeof *names));
	size_t count = 0;
	for (char *word = list ? strtok_r(list, "\", \n", &rest) : NULL; word; word = strtok_r(NULL, "\", \n", &rest)) {
		names = need(reallocarray(names, count + 2, sizeof *names));
		names[count++] = word;
		names[count] = NULL;
	}
	return names;
}

bool is_tunable(const struct code *c, const char *name)
{
	for (char **tunable = c->tunable; *tunable; tunable++)
		if (strcmp(*tunable, name) == 0)
			return true;
	return false;
}

static struct code *code_of(char *text, char *said)
{
	struct code *c = need(calloc(1, sizeof *c));
	c->text = text;
	c->said = said;
	c->single = strstr(text, "\nextern const pl_modelf ") != NULL;
	c->name = text_behind(text, c->single ? "\nextern const pl_modelf " : "\nextern const pl_model ", "; ");
	size_t length = c->name ? strlen(c->name) : 0;
	if (length < 7)
		fail(WRONG_DATA, "what plgen wrote has no descriptor");
	c->name[length - 6] = 0;                /* NAME_model */
	c->tunable = names_of_tunables(text, c->name);
	return c;
}

/* plgen with `more`, NULL for none; false: *error says what is wrong */
static bool run_plgen(const struct toolchain *t, const struct options *o, const char *const *extra, size_t extras,
		      const char *more, struct said *said, char **error)
{
	const char **argv = need(calloc(o->passed_count + 2 * extras + 8, sizeof *argv));
	size_t count = 0;
	argv[count++] = t->plgen;
	argv[count++] = "--fast";
	argv[count++] = "--rows=1";             /* so that NAME_run has the bits of NAME_step */
	if (more)
		argv[count++] = more;
	else if (o->sweep)
		argv[count++] = "--batch";
	for (size_t i = 0; i < o->passed_count; i++)
		argv[count++] = o->passed[i];
	for (size_t i = 0; i < extras; i++) {
		argv[count++] = "-D";
		argv[count++] = extra[i];
	}
	argv[count++] = "--";
	argv[count++] = o->spec;
	*error = run_command(argv, strcmp(o->spec, "-") == 0 ? input_kept() : NULL, said);
	free(argv);
	if (*error) {
		said->status = WRONG_DATA;
		return false;
	}
	if (said->status)
		*error = *said->err ? said->err : format("plgen ended with status %d", said->status);
	return !said->status;
}

struct code *generate(const struct toolchain *t, const struct options *o, const char *const *extra, size_t extras,
		      bool quiet, char **error, int *status)
{
	struct said said = { 0 };
	if (!run_plgen(t, o, extra, extras, NULL, &said, error)) {
		*status = said.status > 2 ? WRONG_DATA : said.status;
		return NULL;
	}
	*status = WRONG_DATA;
	if (!quiet)
		say_text(said.err);
	return code_of(said.out, said.err);
}

struct kernel *generate_kernel(const struct toolchain *t, const struct options *o, const char *const *extra,
			       size_t extras, const char *name, char **error)
{
	struct said said = { 0 };
	struct kernel *k = NULL;
	if (run_plgen(t, o, extra, extras, "--target=opencl", &said, error))
		k = kernel_of(said.out, name, error);
	free(said.out);
	return k;
}

/* ---- from C to a shared object ---- */

/* The compiler with `more`; NULL, or what it said */
static char *run_compiler(const struct toolchain *t, const char *const *more, size_t count)
{
	const char **argv = need(calloc(t->compiler_words + count + 3, sizeof *argv));
	size_t words = 0;
	struct said said;
	for (size_t i = 0; i < t->compiler_words; i++)
		argv[words++] = t->compiler[i];
	argv[words++] = "-I";
	argv[words++] = t->runtime;
	for (size_t i = 0; i < count; i++)
		argv[words++] = more[i];
	char *error = run_command(argv, NULL, &said);
	free(argv);
	if (!error && said.status)
		error = format("the compiler '%s' could not make a program of the model:\n%s", t->compiler[0],
			       said.err);
	return error;
}

static bool write_text(const char *path, const char *text)
{
	FILE *f = fopen(path, "wb");
	if (!f)
		return false;
	bool written = fputs(text, f) >= 0;
	return (fclose(f) == 0) & written;
}

/* phasesf.c is what phases.c is, for models in float. */
static bool is_for_float(const struct toolchain *t, size_t source)
{
	size_t length = strlen(t->source[source]);
	if (length < 4 || t->source[source][length - 3] != 'f')
		return false;
	for (size_t i = 0; i < t->sources; i++)
		if (strlen(t->source[i]) == length - 1 && strncmp(t->source[i], t->source[source], length - 3) == 0)
			return true;
	return false;
}

/* The runtime, of models in float or of the others, as one object */
static char *compile_runtime(const struct toolchain *t, bool single, const char *work, const char *object)
{
	const char **word = need(calloc(t->sources + 5, sizeof *word));
	size_t count = 0;
	word[count++] = "-nostdlib";
	word[count++] = "-r";
	for (size_t i = 0; i < t->sources; i++)
		if (is_for_float(t, i) == single)
			word[count++] = t->source[i];
	char *made = format("%s/runtime.o", work);
	word[count++] = "-o";
	word[count++] = made;
	char *error = run_compiler(t, word, count);
	if (!error && rename(made, object) != 0)
		error = format("cannot write '%s': %s", object, strerror(errno));
	free(word);
	return error;
}

/* The flag for code that has lanes; else NULL */
static const char *wide_lanes(const struct toolchain *t, const struct code *c)
{
	return strstr(c->text, "pl_lanes") ? t->wide : NULL;
}

static char *compile_model(const struct toolchain *t, const struct code *c, const char *work, const char *runtime,
			   const char *object)
{
	char *source = format("%s/model.c", work), *made = format("%s/model.so", work), *error;
	const char *wide = wide_lanes(t, c);
	const char *word[] = { "-shared", "-Wl,-Bsymbolic", source, runtime, "-o", made, "-lm",
			       "-ffp-contract=off", wide };
	if (!write_text(source, c->text))
		error = format("cannot write '%s': %s", source, strerror(errno));
	else
		error = run_compiler(t, word, sizeof word / sizeof *word - (wide ? 0 : 2));
	if (!error && rename(made, object) != 0)
		error = format("cannot write '%s': %s", object, strerror(errno));
	return error;
}

/* A folder `making.*` of the cache, with what may be in one */
static void remove_work(const char *work)
{
	static const char *const made[] = { "model.c", "model.so", "runtime.o" };
	for (size_t i = 0; i < sizeof made / sizeof *made; i++) {
		char *file = format("%s/%s", work, made[i]);
		unlink(file);
		free(file);
	}
	rmdir(work);
}

/* What was killed while it compiled has left its folder there: after a day nobody works in it. */
static void remove_old_work(void)
{
	DIR *cache = opendir(cache_folder());
	struct stat about;
	for (struct dirent *entry; cache && (entry = readdir(cache));) {
		char *path = format("%s/%s", cache_folder(), entry->d_name);
		if (strncmp(entry->d_name, "making.", 7) == 0 && stat(path, &about) == 0 &&
		    about.st_mtime < time(NULL) - 86400)
			remove_work(path);
		free(path);
	}
	if (cache)
		closedir(cache);
}

char *compile(const struct toolchain *t, const struct code *c, bool anew, char **error)
{
	struct hash key = t->key;
	char *runtime = format("%s/runtime%s-%s.o", cache_folder(), c->single ? "f" : "", hash_name(&t->key));
	hash_text(&key, c->text);
	hash_text(&key, wide_lanes(t, c) ? t->wide : "");
	char *object = format("%s/%s-%s.so", cache_folder(), c->name, hash_name(&key));
	*error = NULL;
	if (!anew && access(object, R_OK) == 0)
		return object;
	if (!anew && t->archive)
		runtime = format("%s", t->archive);
	char *work = format("%s/making.XXXXXX", cache_folder());
	struct unfinished folder = { .path = work, .remove = remove_work };
	unfinished_begins();
	if (!mkdtemp(work))
		*error = format("cannot write to '%s': %s", cache_folder(), strerror(errno));
	unfinished_is(*error ? NULL : &folder);
	if (!*error && (anew || access(runtime, R_OK) != 0))
		*error = compile_runtime(t, c->single, work, runtime);
	if (!*error)
		*error = compile_model(t, c, work, runtime, object);
	remove_work(work);
	unfinished_ends(&folder);
	remove_old_work();
	return *error ? NULL : object;
}
