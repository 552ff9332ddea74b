% SPDX-License-Identifier: GPL-3.0-or-later
% told.m SOURCE_ROOT, in the folder where octave.sh has left specs, records and rows: a line `good NAME`, `bad NAME` or
% `skip NAME: why` for each case, `end` when all have been told.
1;

function tell(name, good, varargin)
	if ! good
		for i = 1:numel(varargin)
			disp(varargin{i});
		end
	end
	words = {"bad", "good"};
	printf("%s %s\n", words{1 + logical(good)}, name);
end

function r = rows_of(name, m, type)
	f = fopen([name, ".rows"], "rb");
	r = reshape(fread(f, Inf, type), numel(m.outputs) + 1, []).';
	fclose(f);
end

function beside(name, m, y, type)
	r = rows_of(name, m, type);
	good = rows(y) > 10 && isequal(y, r(:, 2:end)) && isequal(m.t, r(:, 1));
	tell([name, ": the rows and times of plmain.c"], good, size(y), size(r));
end

function refuses(name, expected, call)
	said = "nothing was raised";
	try
		call();
	catch why
		said = why.message;
	end
	tell(["refuses ", name], strcmp(said, expected), expected, said);
end

root = argv(){end};
model = @(name, varargin) plgen_model([root, "/models/", name, ".spec"], varargin{:});
record = dlmread("held.csv", ",", 1, 0);
count = 256;

m = model("sdcsf");
beside("sdcsf", m, m.run(2000), "double");
m = model("sdcsf", "k2", 80.5);
beside("weaker", m, m.run(500), "double");
m = model("stop");
beside("stop", m, m.run(5000), "double");
m = model("pendulum");
beside("pendulum", m, m.run(100), "double");
m = plgen_model("held.spec");
beside("held", m, m.run(record(1:count + 1, :)), "double");
m = plgen_model("smooth.spec");
beside("smooth", m, m.run(record(1:count + 2, :)), "double");
m = plgen_model("held.spec", "-real", "float");
beside("single", m, m.run(record(1:count + 1, :)), "single");
m = plgen_model(fileread("held.spec"), "k", 70.25, "c", 0.1);
beside("tuned", m, m.run(record(1:count + 1, :)), "double");
m = plgen_model("held.spec");
m.retune("k", 70.25, "c", 0.1);
beside("tuned", m, m.run(record(1:count + 1, :)), "double");
tell("params read back", isequal(m.params, struct("k", 70.25, "c", 0.1)), m.params);
m.reset();
r = rows_of("tuned", m, "double");
y = [m.run(record(1:50, :)); m.run(record(51:52, :)); m.run(record(53:count + 1, :))];
tell("pieces put together are one run, after reset", isequal(y, r(:, 2:end)), size(y));
m = plgen_model("smooth.spec");
r = rows_of("smooth", m, "double");
y = [m.run(record(1:50, :)); m.run(record(51:51, :)); m.run(record(52:count + 2, :))];
tell("... with samples ahead", isequal(y, r(:, 2:end)), size(y));

a = plgen_model("held.spec", "k", 60);
a.run(record(1:30, :));
b = a.copy();
y = a.state;
t = a.time;
a.retune("m", 2.5);
tell("another param: state, time and tuned ones stay", isequal(a.state, y) && a.time == t && a.params.k == 60 && ...
	 a.params.m == 2.5 && ! isfield(b.params, "m"), a.params, b.params);
c = plgen_model("held.spec", "k", 60, "m", 2.5);
c.put(y, t);
tell("... and it goes on as the model of these params", isequal(a.run(record), c.run(record)));
c = b.copy();
b.retune("k", 10);
p = c.run(record(31:60, :));
q = b.run(record(31:60, :));
a = plgen_model("held.spec", "k", 60);
whole = a.run(record(1:60, :));
tell("copies go their own ways", isequal(p, whole(31:60, :)) && ! isequal(q, p) && c.params.k == 60);
a = plgen_model("held.spec");
a.retune("-step", 1 / 128);
tell("another step", a.h == 1 / 128 && rows(a.run(record)) == 301 && a.t(2) == 1 / 128);
a = model("sdcsf");
a.retune("-step", 0.02);
a.run(3);
tell("another step of a model without tunable params", a.h == 0.02 && isequal(a.t, [0; 0.02; 0.04; 0.06]), a.h, a.t);
m = model("sdcsf");
m.jump(1500);
other = model("sdcsf");
y = other.run(1500);
tell("a jump is as many steps", m.time == 15 && max(abs(m.out() - y(end, :))) < 1e-14 && max(abs(y(end, :))) > 1e-3);
m = model("sdcsf");
y = m.at(0.01);
z = m.step();
tell("inside a step, and one", max(abs(y - m.state)) < 1e-15 && isequal(z, other.copy().out()) == false && ...
	 isequal(z, rows_of("sdcsf", m, "double")(2, 2:end)));
m.state = [1, 2, 3, 4];
tell("a state read back, time stays", isequal(m.state, [1, 2, 3, 4]) && m.time == 0.01);
m = plgen_model("held.spec");
tell("names", isequal(m.states, {"x", "y", "x'", "y'"}) && isequal(m.inputs, {"push", "base"}) && ...
	 isequal(m.outputs, {"x", "y", "pull", "speed"}) && isequal(m.tunable, {"k", "c"}) && strcmp(m.name, "held"));

refuses("an unknown name as plgen does", ["<stdin>:3:13: error: unknown name 'foo'\nx'' + 4*x = foo\n" ...
        "            ^\nnote: did you mean 'cos'?"], @() plgen_model("model a\ncoord x\nx'' + 4*x = foo\nstep 0.1\n"));
refuses("a step of 0", "held: the step is not above 0", @() plgen_model("held.spec").retune("-step", 0));
m = plgen_model("hard.spec");
refuses("a run that leaves the finite numbers", "hard: t = 0.4: the step has left the finite numbers", @() m.run(100));
tell("... tells when, and its status", m.status == 1 && numel(m.t) == 4, m.status, m.t);
refuses("a record too narrow", "expected rows of 2 numbers, the inputs", @() plgen_model("held.spec").run(ones(5, 3)));
one = plgen_model("model a\ncoord x\ninput u\nx'' + 4*x = u\nstep 0.1\n");
tell("a record of one input is a row or a column", isequal(one.copy().run(1:3), one.copy().run((1:3)')));
refuses("a record too wide for one input", "expected rows of 1 numbers, the inputs", @() one.run(ones(2, 2)));
refuses("a record that is no matrix", "expected rows of 1 numbers, the inputs", @() one.run({1, 2}));
refuses("a jump where there is none", "plgen_mex: the model has no jump", @() plgen_model("held.spec").jump(3));
refuses("the Phi of a stop", "stop: not linear, so it has no Phi: it would leave out max(x, 0)", ...
		@() model("stop").Phi);

m = plgen_model("held.spec", "k", 70.25);
A = [0, 0, 1, 0; 0, 0, 0, 1; -70.25 / 2, 70.25 / 2, -0.3, 0.3; 70.25, -73.25, 0.6, -0.6];
tell("Phi at the params of now", max(max(abs(m.Phi - expm(A / 64)))) < 1e-13, m.Phi - expm(A / 64));
if ! isfield(m.explain, "ss")
	disp("skip the state space: --explain=json tells none");
else
	B = [0, 0; 0, 0; 0.5, 0; 0, 3];
	C = [1, 0, 0, 0; 0, 1, 0, 0; 0, 70.25, 0, 0; 0, 0, 1, 0];
	D = [0, 0; 0, 0; 0, -70.25; 0, 0];
	tell("the state space", max(max(abs([m.ss.A, m.ss.B; m.ss.C, m.ss.D] - [A, B; C, D]))) < 1e-13 && ...
         max(max(abs(m.ss.discrete.A - expm(A / 64)))) < 1e-13 && isequal(m.ss.inputs(:), {"push"; "base"}), m.ss);
	direct = C * ((2i * pi * 0.3 * eye(4) - A) \ B) + D;
	r = m.response([0.3, 1]);
    tell("the response", isequal(size(r), [4, 2, 2]) && max(max(abs(r(:, :, 1) - direct))) < 1e-9, r(:, :, 1) - direct);
end

fid = fopen("late.spec", "w");
fprintf(fid, "model late\ncoord x\ninput u\nx'' + 0.3*x' + x = u(t - 0.1) + 0.5*u\nstep 0.05\n");
fclose(fid);
late = plgen_model("late.spec");
refuses("the state space of a delay", ["late: inputs are delayed, so it has no state space over them: it would " ...
		"leave out u.delayed1; response counts them"], @() late.ss);
s = 2i * pi * [0.1, 0.5];
direct = (exp(-0.1 * s) + 0.5) ./ (s .^ 2 + 0.3 * s + 1);
tell("the response to a delayed input", isequal(size(late.response([0.1, 0.5])), [2, 1, 2]) && ...
     max(abs(late.response([0.1, 0.5])(1, 1, :)(:).' - direct)) < 1e-14, late.response([0.1, 0.5])(1, 1, :)(:).' - direct);
bent = plgen_model(["model bent\ncoord x\ninput u\nx'' + 0.3*x' + sin(x) = u(t - 0.1) + 0.5*u\nstep 0.05\n"]);
tell("that of its linear equations", max(abs(bent.response([0.1, 0.5], false, "rest")(1, 1, :)(:).' - direct)) < 1e-14, ...
	 bent.response([0.1, 0.5], false, "rest"));

scaled = ["model scaled\nparam m = 2 \"kg\", k = 0.1 \"N/mm\"\ntunable k\ncoord x \"mm\"\nm*x'' + k*x = 0\n", ...
		  "init x = 3 \"mm\"\nstep 0.01\n"];
m = plgen_model(scaled, "k", 0.25);
other = plgen_model(scaled, "k", "0.25");
y = m.run(50);
tell("params in units of their own", m.params.k == 0.25 && isequal(plgen_model(scaled).params.k, 0.1) && ...
	 max(max(abs(y - other.run(50)))) < 1e-13 * max(max(abs(y))), m.params, y(end, :));

bent = ["model bent\nparam k = 3\ncoord x, y\ninput u\nx'' + 0.2*x' + sin(x) + x*y = u\ny' + k*y = x^2\n", ...
		"init x = 0.5\noutput f = x*y\noutput x\nstep 0.01\nscheme taylor\n"];
slope = @(x, y) [0, 0, 1; 2 * x, -3, 0; -cos(x) - y, -x, -0.2];
m = plgen_model(bent);
[A, B, C, D] = m.linearise("x=0.25,y=0.5,x'=2");
tell("at a point: by the derivatives written out", max(max(abs(A - slope(0.25, 0.5)))) < 1e-15 && ...
	 isequal(B, [0; 0; 1]) && max(max(abs(C - [0.5, 0.25, 0; 1, 0, 0]))) < 1e-15, A - slope(0.25, 0.5), C);
m.state = [0.125, 1, 0];
tell("where it is now", max(max(abs(m.state_space(false, "now").A - slope(0.125, 1)))) < 1e-15);
s = m.ss;
[said, id] = lastwarn();
tell("at rest without a word of where, and that is said", strcmp(id, "plgen:linearised") && ...
	 strcmp(s.at, "linearised at rest: x = 0, y = 0") && strcmp(said, ["bent: not linear, and ", s.at]) && ...
	 isequal(s.A, slope(0, 0)), said, s.at);
p = sort(m.poles());
tell("its poles", max(abs(p - sort(eig(slope(0, 0))))) < 1e-12, p);

try
	pkg load control
catch
	disp("skip lqr, lqe, c2d: no octave-control");
end
if exist("lqr", "file")
	m = plgen_model("plain.spec");
	[A, B, C, D] = m.linearise();
	sys = ss(A, B, C, D);
	Q = diag([100, 100, 1, 1]);
	R = eye(2);
	K = lqr(sys, Q, R);
	[V, e] = eig([A, -B * B'; -Q, -A']);
	V = V(:, real(diag(e)) < 0);
	direct = real(B' * V(5:8, :) / V(1:4, :));
    tell("lqr: as the Hamiltonian's stable subspace", max(max(abs(K - direct))) < 1e-9 * max(abs(K(:))), K - direct);
	L = lqe(A, B, C, eye(2), eye(4));
	[V, e] = eig([A', -C' * C; -B * B', -A]);
	V = V(:, real(diag(e)) < 0);
	direct = real(V(5:8, :) / V(1:4, :)) * C';
	tell("lqe: likewise", max(max(abs(L - direct))) < 1e-9 * max(abs(L(:))), L - direct);
	step = c2d(sys, m.h);
    tell("c2d: the discrete one of plgen", max(max(abs([step.a - m.ss.discrete.A, step.b - m.ss.discrete.B]))) < 1e-13);
end
disp("end");
