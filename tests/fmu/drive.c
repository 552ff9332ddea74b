/* SPDX-License-Identifier: GPL-3.0-or-later */
/* drive FMU.so TOKEN MODEL.so NAME [FMU2.so TOKEN2 MODEL2.so NAME2]: an FMU against the model's own functions, which
 * are compiled apart from it: the same bits, whatever the importer does. SINGLE: of models in float. */
#include "importer.h"

#include "plrt.h"

#ifdef SINGLE
typedef float real;
typedef pl_modelf model;
#else
typedef double real;
typedef pl_model model;
#endif

enum { MOST = 64, STEPS = 400 };

static int failures;

static void judge(bool good, const char *what)
{
	printf("%sok - %s\n", good ? "" : "not ", what);
	failures += !good;
}

/* A model by its own functions, and what an importer would set */
struct reference {
	const model *m;
	void *s;
	real last[MOST];
};

static struct reference reference_new(const model *m)
{
	struct reference r = { m, calloc(1, m->size), { 0 } };
	m->init(r.s);
	return r;
}

static unsigned input_at(int k) { return 1 + (unsigned)k; }
static unsigned output_at(const model *m, int k) { return input_at(m->inputs) + (unsigned)k; }
static unsigned param_at(const model *m, int k) { return output_at(m, m->outputs) + (unsigned)k; }
static unsigned state_at(const model *m, int k) { return param_at(m, m->params) + (unsigned)k; }

/* Values that are exact in float too, so that both sides are given the same */
static void fill(double *u, int inputs, int k)
{
	for (int j = 0; j < inputs; j++)
		u[j] = ((k * 37 + j * 11) % 64 - 32) / 16.0;
}

/* n steps to the sample u: held inputs at it, ramps to it */
static void reference_step(struct reference *r, const double *u, int n)
{
	real now[MOST] = { 0 };
	for (int k = 1; k <= n; k++) {
		for (int j = 0; j < r->m->inputs; j++)
			now[j] = k == n || r->m->start_samples[j] == 0 ? (real)u[j] :
				 r->last[j] + ((real)u[j] - r->last[j]) * ((real)k / (real)n);
		r->m->step(r->s, now);
	}
	for (int j = 0; j < r->m->inputs; j++)
		r->last[j] = (real)u[j];
}

static void reference_start(struct reference *r, const double *u)
{
	for (int j = 0; j < r->m->inputs; j++)
		r->last[j] = (real)u[j];
	if (r->m->hold)
		r->m->hold(r->s, r->last);
}

static bool set_inputs(const struct fmu *f, void *i, const model *m, const double *u)
{
	for (int j = 0; j < m->inputs; j++) {
		unsigned at = input_at(j);
		if (!set(f, i, &at, 1, &u[j]))
			return false;
	}
	return true;
}

/* Outputs and states of both, bit for bit; prints the first that differs */
static bool same(const struct fmu *f, void *i, const struct reference *r, const char *where)
{
	real own[2 * MOST];
	double value[2 * MOST];
	unsigned at[2 * MOST];
	const model *m = r->m;
	int n = m->outputs + m->states;
	for (int k = 0; k < n; k++)
		at[k] = k < m->outputs ? output_at(m, k) : state_at(m, k - m->outputs);
	m->out(r->s, own);
	m->get(r->s, own + m->outputs);
	if (!get(f, i, at, (size_t)n, value)) {
		printf("# %s: the values could not be had\n", where);
		return false;
	}
	for (int k = 0; k < n; k++) {
		double mine = own[k];
		if (memcmp(&mine, &value[k], sizeof mine) == 0)
			continue;
		printf("# %s: value %d is %.17g, of the model's own functions %.17g\n", where, k, value[k], mine);
		return false;
	}
	return true;
}

/* From k to `until`, n steps a call; the FMU with the reference, or alone where it has none */
static bool run(const struct fmu *f, void *i, struct reference *r, const model *m, int k, int until, int n)
{
	bool good = true;
	double u[MOST], h = m->h;
	for (; k < until && good; k += n) {
		fill(u, m->inputs, k);
		good = set_inputs(f, i, m, u) && step(f, i, k * h, n * h);
		if (!good)
			printf("# step %d was refused\n", k);
		if (r) {
			reference_step(r, u, n);
			good = good && same(f, i, r, "run");
		}
	}
	return good;
}

static void *started(const struct fmu *f, const model *m, struct reference *r)
{
	double u[MOST];
	void *i = make(f, f->token);
	fill(u, m->inputs, 5);
	if (r)
		reference_start(r, u);
	return i && enter(f, i, 0) && set_inputs(f, i, m, u) && leave(f, i) ? i : NULL;
}

static void try_steps(const struct fmu *f, const model *m, int n, const char *what)
{
	struct reference r = reference_new(m);
	void *i = started(f, m, &r);
	judge(i && same(f, i, &r, "start") && run(f, i, &r, m, 0, STEPS, n), what);
	end(f, i);
}

/* Bytes of two saved states */
static bool equal_states(const struct fmu *f, void *i, void *a, void *b)
{
	size_t size, other;
	char *one = bytes_of(f, i, a, &size), *two = bytes_of(f, i, b, &other);
	bool equal = one && two && size == other && memcmp(one, two, size) == 0;
	free(one);
	free(two);
	return equal;
}

static void copy_reference(struct reference *to, const struct reference *from)
{
	memcpy(to->s, from->s, from->m->size);
	memcpy(to->last, from->last, sizeof to->last);
}

static void try_rollback(const struct fmu *f, const model *m)
{
	struct reference r = reference_new(m), kept = reference_new(m), once_more = reference_new(m);
	void *i = started(f, m, &r);
	bool good = i && run(f, i, &r, m, 0, 100, 1);
	void *at_100 = save(f, i);
	copy_reference(&kept, &r);
	copy_reference(&once_more, &r);
	good = good && run(f, i, &r, m, 100, 200, 1);
	judge(good && restore(f, i, at_100), "a state is saved and restored");
	void *again_100 = save(f, i);
	judge(equal_states(f, i, at_100, again_100), "a restored state has the same bytes");
	judge(run(f, i, &kept, m, 100, 200, 1), "steps after a rollback");
	judge(!step(f, i, 100 * (double)m->h, m->h), "a step from where the model is not is refused");

	size_t size;
	char *bytes = bytes_of(f, i, at_100, &size);
	void *other = make(f, f->token), *read = bytes ? state_of(f, other, bytes, size) : NULL;
	judge(read && restore(f, other, read) && run(f, other, &once_more, m, 100, 200, 1),
	      "a serialized state goes on in another instance");
	bytes[0] = (char)~bytes[0];
	judge(!state_of(f, other, bytes, size) && !state_of(f, other, bytes, 3), "bytes of something else are refused");
	void *states[] = { at_100, again_100, read };
	for (size_t k = 0; k < sizeof states / sizeof *states; k++)
		forget(f, i, states[k]);
	free(bytes);
	end(f, other);
	end(f, i);
}

#if FMI == 3
/* The model's own count of crossings; NULL: it has no breakpoints */
typedef uint64_t crossed(const void *s);

static crossed *crossed_of(void *object, const char *name)
{
	char symbol[256];
	snprintf(symbol, sizeof symbol, "%s_crossed", name);
	return *(crossed **)(void *[]){ dlsym(object, symbol) };
}

/* As reference_step, up to the end of the first step with a crossing; steps that were done */
static int reference_steps_early(struct reference *r, const double *u, int n, crossed *count)
{
	real now[MOST] = { 0 };
	uint64_t before = count ? count(r->s) : 0;
	int k = 0;
	do {
		k++;
		for (int j = 0; j < r->m->inputs; j++)
			now[j] = k == n || r->m->start_samples[j] == 0 ? (real)u[j] :
				 r->last[j] + ((real)u[j] - r->last[j]) * ((real)k / (real)n);
		r->m->step(r->s, now);
	} while (k < n && (!count || count(r->s) == before));
	memcpy(r->last, now, sizeof r->last);
	return k;
}

/* A call of n steps from step k on: where it ends, in which state */
static bool step_as_reference(const struct fmu *f, void *i, struct reference *r, int k, int n, crossed *count,
			      const double *u, int *done)
{
	double h = r->m->h, at = -1;
	bool early = false, good = set_inputs(f, i, r->m, u) && step_early(f, i, k * h, n * h, &early, &at);
	*done = reference_steps_early(r, u, n, count);
	if (good && early == (*done < n) && at > (k + *done - 0.01) * h && at < (k + *done + 0.01) * h)
		return same(f, i, r, "early return");
	printf("# from step %d it came to %.9g, %searly, and a crossing is in the step that ends at %.9g\n", k, at,
	       early ? "" : "not ", (k + *done) * h);
	return false;
}

/* Calls of up to eight steps that end with the step in which a breakpoint was crossed, each taken twice, the second
 * time from a saved state; what is left of a call's length comes next, towards the same inputs. */
static void try_early(const struct fmu *f, const model *m, crossed *count)
{
	enum { MANY = 8 };
	struct reference r = reference_new(m), kept = reference_new(m);
	double u[MOST];
	int returns = 0;
	void *i = make_early(f);
	bool good = i && enter(f, i, 0);
	fill(u, m->inputs, 5);
	reference_start(&r, u);
	good = good && set_inputs(f, i, m, u) && leave(f, i);
	for (int k = 0, done = 0; k < STEPS && good; k += done) {
		int n = MANY - k % MANY;
		void *state = save(f, i);
		copy_reference(&kept, &r);
		fill(u, m->inputs, k / MANY);
		good = step_as_reference(f, i, &r, k, n, count, u, &done);
		copy_reference(&r, &kept);
		good = good && restore(f, i, state) && step_as_reference(f, i, &r, k, n, count, u, &done);
		returns += done < n;
		forget(f, i, state);
	}
	judge(good, "a call ends with the step in which a breakpoint is crossed, after a rollback too");
	printf("# %d early returns\n", returns);
	judge((returns > 0) == (count != NULL), count ? "and some do" : "and none does without breakpoints");
	end(f, i);
}
#endif

static void try_reset(const struct fmu *f, const model *m)
{
	struct reference r = reference_new(m);
	double u[MOST];
	void *i = started(f, m, NULL);
	bool good = i && run(f, i, NULL, m, 0, 50, 1) && reset(f, i);
	fill(u, m->inputs, 5);
	reference_start(&r, u);
	judge(good && enter(f, i, 0) && set_inputs(f, i, m, u) && leave(f, i) && run(f, i, &r, m, 0, 100, 1),
	      "after a reset all is as at first");
	end(f, i);
}

static void try_start(const struct fmu *f, const model *m)
{
	struct reference r = reference_new(m);
	void *i = make(f, f->token);
	real y[MOST];
	double u[MOST], t0 = 1.5, h = m->h;
	bool good = enter(f, i, t0);
	m->get(r.s, y);
	for (int k = 0; k < m->states; k++) {
		unsigned at = state_at(m, k);
		double start = 0.0625 * (k + 1);
		y[k] = (real)start;
		good = good && set(f, i, &at, 1, &start);
	}
	fill(u, m->inputs, 5);
	m->set(r.s, (real)t0, y);
	reference_start(&r, u);
	good = good && set_inputs(f, i, m, u) && leave(f, i) && same(f, i, &r, "start");
	for (int k = 0; k < 100 && good; k++) {
		fill(u, m->inputs, k);
		good = set_inputs(f, i, m, u) && step(f, i, t0 + k * h, h);
		reference_step(&r, u, 1);
		good = good && same(f, i, &r, "step from another start");
	}
	judge(good, "another time and other states to start from");
	unsigned at = state_at(m, 0);
	judge(!set(f, i, &at, 1, &t0), "a state is not set between steps");
	end(f, i);
}

static void try_params(const struct fmu *f, const model *m)
{
	struct reference r = reference_new(m);
	double u[MOST], value, bad = 0.0;
	real p[MOST];
	void *i = make(f, f->token);
	bool good = enter(f, i, 0);
	unsigned at = param_at(m, 0);
	if (m->params == 0) {
		end(f, i);
		return;
	}
	memcpy(p, m->param_values, (size_t)m->params * sizeof *p);
	p[0] = (real)(value = 3.5);
	good = good && set(f, i, &at, 1, &value);
	good = good && m->retune(r.s, p, m->h) == 0;
	fill(u, m->inputs, 5);
	reference_start(&r, u);
	judge(good && set_inputs(f, i, m, u) && leave(f, i) && run(f, i, &r, m, 0, 50, 1),
	      "another param from the start");
	p[0] = (real)(value = 1.25);
	good = set(f, i, &at, 1, &value) && m->retune(r.s, p, m->h) == 0;
	judge(good && run(f, i, &r, m, 50, 100, 1), "and another on the way");
	void *state = save(f, i);
	bad = bad / bad;
	good = set(f, i, &at, 1, &bad) && !step(f, i, 100 * (double)m->h, m->h);
	judge(good, "a param that cannot be is an error in the next step");
	/* it is taken like any other: a scheme that chooses its substeps begins anew there */
	struct reference better = reference_new(m);
	copy_reference(&better, &r);
	good = m->retune(better.s, p, m->h) == 0 && set(f, i, &at, 1, &value);
	judge(good && run(f, i, &better, m, 100, 150, 1), "a better one ends that");
	judge(restore(f, i, state) && run(f, i, &r, m, 100, 150, 1), "a saved state has its params");
	forget(f, i, state);
	end(f, i);
}

static void try_errors(const struct fmu *f, const model *m)
{
	double value = 0;
	unsigned time_at = 0, none = 1000000, out = output_at(m, 0);
	judge(!make(f, "another"), "another token is refused");
	void *i = started(f, m, NULL);
	int before = logged;
	judge(!step(f, i, 0, 0.5 * (double)m->h) && !step(f, i, 0, 1.4 * (double)m->h) && !step(f, i, 0, 0) &&
	      !step(f, i, 0, -(double)m->h), "steps that are no multiple are refused");
	judge(!set(f, i, &out, 1, &value) && !set(f, i, &time_at, 1, &value) && !set(f, i, &none, 1, &value) &&
	      !get(f, i, &none, 1, &value), "what is no variable, or not to be set, is refused");
	judge(stub_fails(f, i) && !enter(f, i, 0) && !leave(f, i), "what is not offered, or not now, is an error");
	judge(logged > before + 9, "each with a message");
	before = logged;
	judge(be_silent(f, i) && stub_fails(f, i) && logged == before, "no message where none is wanted");
	judge(get(f, i, &time_at, 1, &value) && value == 0 && step(f, i, 0, m->h) && get(f, i, &time_at, 1, &value) &&
	      (real)value == m->h, "and the time is as it was");
	end(f, i);
}

/* What the description says: outputs depend on no input between steps; a param that is not tunable has its value */
static void try_dependencies(const struct fmu *f, const model *m)
{
	const char *constant = getenv("CONSTANT");
	double u[MOST], before[MOST], after[MOST], value = 0;
	unsigned at[MOST], first = state_at(m, m->states);
	void *i = started(f, m, NULL);
	bool good = i && run(f, i, NULL, m, 0, 10, 1);
	for (int k = 0; k < m->outputs; k++)
		at[k] = output_at(m, k);
	fill(u, m->inputs, 40);
	good = good && get(f, i, at, (size_t)m->outputs, before) && set_inputs(f, i, m, u) &&
	       get(f, i, at, (size_t)m->outputs, after);
	judge(good && memcmp(before, after, (size_t)m->outputs * sizeof *before) == 0,
	      "inputs that are set change no output before a step");
	if (constant)
		judge(get(f, i, &first, 1, &value) && value == atof(constant) && !set(f, i, &first, 1, &value),
		      "a param that is not tunable has its value, and is not set");
	end(f, i);
}

/* Two FMUs, each fed with an output of the other, every step taken twice: the second time from saved states, with what
 * the first has shown of its end. */
static void try_pair(const struct fmu *f, const model *const m[2])
{
	struct reference r[2] = { reference_new(m[0]), reference_new(m[1]) };
	void *i[2] = { started(&f[0], m[0], &r[0]), started(&f[1], m[1], &r[1]) };
	double h = m[0]->h, u[2][MOST];
	bool good = i[0] && i[1];
	for (int j = 0; j < 2; j++)
		fill(u[j], m[j]->inputs, 5);
	for (int k = 0; k < 200 && good; k++) {
		void *state[2] = { save(&f[0], i[0]), save(&f[1], i[1]) };
		struct reference kept[2] = { reference_new(m[0]), reference_new(m[1]) };
		for (int j = 0; j < 2; j++) {
			copy_reference(&kept[j], &r[j]);
		}
		for (int pass = 0; pass < 2 && good; pass++) {
			for (int j = 0; j < 2 && pass > 0; j++) {
				good = good && restore(&f[j], i[j], state[j]);
				copy_reference(&r[j], &kept[j]);
			}
			for (int j = 0; j < 2; j++) {
				good = good && set_inputs(&f[j], i[j], m[j], u[j]) && step(&f[j], i[j], k * h, h);
				reference_step(&r[j], u[j], 1);
				good = good && same(&f[j], i[j], &r[j], "pair");
			}
			for (int j = 0; j < 2; j++) {
				unsigned at = output_at(m[1 - j], 0);
				good = good && get(&f[1 - j], i[1 - j], &at, 1, &u[j][0]);
			}
		}
		for (int j = 0; j < 2; j++) {
			forget(&f[j], i[j], state[j]);
			free(kept[j].s);
		}
	}
	judge(good, "two FMUs coupled, with a rollback in each step");
	judge(u[0][0] != 0 && u[1][0] != 0, "and something has moved");
}

static const model *model_of(const char *path, const char *name)
{
	char symbol[256];
	void *object = dlopen(path, RTLD_NOW | RTLD_LOCAL);
	snprintf(symbol, sizeof symbol, "%s_model", name);
	if (!object) {
		printf("not ok - %s\n", dlerror());
		exit(1);
	}
	const model *m = function_of(object, symbol);
	if (m->version != PL_MODEL_VERSION || m->real_size != (int)sizeof(real)) {
		printf("not ok - another descriptor\n");
		exit(1);
	}
	return m;
}

static struct fmu load(const char *path, const char *token)
{
	struct fmu f = { dlopen(path, RTLD_NOW | RTLD_LOCAL), token };
	if (!f.object) {
		printf("not ok - %s\n", dlerror());
		exit(1);
	}
	return f;
}

int main(int argc, char **argv)
{
	if (argc != 5 && argc != 9)
		return 2;
	struct fmu f[2] = { load(argv[1], argv[2]) };
	const model *m[2] = { model_of(argv[3], argv[4]) };
	setvbuf(stdout, NULL, _IOLBF, 0);
	if (argc == 9) {
		f[1] = load(argv[5], argv[6]);
		m[1] = model_of(argv[7], argv[8]);
		try_pair(f, m);
		return failures > 0;
	}
	try_steps(&f[0], m[0], 1, "step by step");
	try_steps(&f[0], m[0], 4, "four steps a call");
	try_rollback(&f[0], m[0]);
#if FMI == 3
	try_early(&f[0], m[0], crossed_of(dlopen(argv[3], RTLD_NOW | RTLD_LOCAL), argv[4]));
#endif
	try_reset(&f[0], m[0]);
	try_start(&f[0], m[0]);
	try_params(&f[0], m[0]);
	try_errors(&f[0], m[0]);
	try_dependencies(&f[0], m[0]);
	return failures > 0;
}
