function mpc = case6ww
% Wood and Wollenberg, Power Generation, Operation, and Control, 2nd edition (1996), 6-bus example of pages 104-124;
% numbers as MATPOWER's case6ww gives them.
% Loads and set points as published; costs and ratings, which a power flow does not need, are left out.
mpc.version = '2';
mpc.baseMVA = 100;

%% bus_i type Pd Qd Gs Bs area Vm Va baseKV zone Vmax Vmin
mpc.bus = [
	1 3 0 0 0 0 1 1.05 0 230 1 1.1 0.9;
	2 2 0 0 0 0 1 1.05 0 230 1 1.1 0.9;
	3 2 0 0 0 0 1 1.07 0 230 1 1.1 0.9;
	4 1 70 70 0 0 1 1 0 230 1 1.1 0.9;
	5 1 70 70 0 0 1 1 0 230 1 1.1 0.9;
	6 1 70 70 0 0 1 1 0 230 1 1.1 0.9;
];

%% bus Pg Qg Qmax Qmin Vg mBase status Pmax Pmin
mpc.gen = [
	1 0 0 100 -100 1.05 100 1 9999 0;
	2 50 0 100 -100 1.05 100 1 9999 0;
	3 60 0 100 -100 1.07 100 1 9999 0;
];

%% fbus tbus r x b rateA rateB rateC ratio angle status angmin angmax
mpc.branch = [
	1 2 0.1 0.2 0.04 0 0 0 0 0 1 -360 360;
	1 4 0.05 0.2 0.04 0 0 0 0 0 1 -360 360;
	1 5 0.08 0.3 0.06 0 0 0 0 0 1 -360 360;
	2 3 0.05 0.25 0.06 0 0 0 0 0 1 -360 360;
	2 4 0.05 0.1 0.02 0 0 0 0 0 1 -360 360;
	2 5 0.1 0.3 0.04 0 0 0 0 0 1 -360 360;
	2 6 0.07 0.2 0.05 0 0 0 0 0 1 -360 360;
	3 5 0.12 0.26 0.05 0 0 0 0 0 1 -360 360;
	3 6 0.02 0.1 0.02 0 0 0 0 0 1 -360 360;
	4 5 0.2 0.4 0.08 0 0 0 0 0 1 -360 360;
	5 6 0.1 0.3 0.06 0 0 0 0 0 1 -360 360;
];
