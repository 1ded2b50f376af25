"""Scripts of fixes that average, store and write, and what asemd and LAMMPS make of them: the same files.

Each case is a list of commands after `BASE`; runs follow from `RUNS`.
"""
BASE = """
units lj
atom_style atomic
atom_modify map array
lattice fcc 0.8442
region b block 0 2 0 2 0 2
create_box 1 b
create_atoms 1 box
mass 1 1.0
velocity all create 1.44 87287
pair_style lj/cut 1.5
pair_coeff 1 1 1.0 1.0 1.5
neighbor 0.15 bin
fix 1 all nve
compute t all temp
compute ke all ke/atom
compute pe all pe
compute s all stress/atom NULL
variable v equal c_t*2
variable vv vector "[1,2,3,4,5,6]"
variable ax atom x*2
group some id 1:12
thermo 10
"""
RUNS = "run 30\nrun 17\nrun 23\n"
CASES = {
    "ave/time": """
fix a all ave/time 2 3 10 c_t c_t[1] v_v c_thermo_press[*] file a1.txt off 5
fix b all ave/time 5 2 10 c_t mode vector file a2.txt
fix b2 all ave/time 5 2 10 c_t v_vv[1] c_t[*] mode scalar file a22.txt ave running
fix c all ave/time 5 2 10 c_t file a3.txt ave window 2 start 20 format " %10.3f" title1 "# hello" title2 "# two"
fix d all ave/time 1 1 10 c_t v_v off 2 ave running file a4.txt overwrite
fix y1 all ave/time 5 2 10 c_t mode vector file y1.yaml
fix y2 all ave/time 5 2 10 c_t c_t mode vector file a23.txt ave running title1 "" title3 "# x"
fix y3 all ave/time 5 2 10 c_t[1] v_vv[1] c_thermo_pe mode scalar file y2.yml ave running
fix y4 all ave/time 5 2 10 c_thermo_press v_vv mode vector file y3.yaml
fix fa all ave/time 10 2 20 f_a[*] f_d[1] file fa.txt
thermo_style custom step temp f_a[1] f_a[2] f_c f_d[1] f_b[1] f_y2[1][2] f_y3[3]
""",
    "before what acts at the end of steps": """
variable l equal lx
variable mean atom vx*vx
fix p1 all print 2 "$(c_t:%.8f) $l" file p1.txt screen no
fix a all ave/time 1 4 5 c_t v_l c_thermo_press file a1.txt
fix c all ave/atom 3 2 15 vx
fix v all vector 3 c_t
fix r all temp/rescale 3 1.0 1.0 0.01 0.5
fix b all temp/berendsen 1.0 1.0 0.5
fix p2 all print 2 "$(c_t:%.8f) $l" file p2.txt screen no
fix d all deform 2 x erate 0.1
fix p3 all print 2 "$(c_t:%.8f) $l" file p3.txt screen no
thermo_style custom step temp f_a[1] f_a[2] f_a[3] lx
""",
    "vector and print": """
fix p all print 10 "step $(step) T $(c_t:%.8f)" file p.txt screen no
fix p2 all print 10 "step $(step) pe $(c_pe:%.8f)" append p3.txt title hello
fix p4 all print 10 "step $(step)" append p5.txt
variable next equal step+7
fix p3 all print v_next "step $(step)" file p4.txt
fix vec all vector 5 c_t
fix vec2 all vector 5 c_t[1] c_t[2] nmax 3
run 30
variable s equal sum(f_vec)
print "$(f_vec[1]:%.9f) $(f_vec[7]:%.9f) $(v_s:%.9f) $(f_vec2[2][1]:%.9f)" file vec.txt
""",
    "ave/atom and ave/histo": """
fix a all ave/atom 2 3 10 vx fy x c_ke c_s[*]
fix a1 some ave/atom 5 2 10 z
fix h all ave/histo 2 3 10 0 5 5 c_ke file h1.txt mode vector
fix h2 all ave/histo 2 3 10 -2 2 4 vx vy vz file h2.txt beyond extra ave running mode vector
fix h3 all ave/histo 2 3 10 0 2 4 c_t c_t[1] file h3.txt beyond end ave window 2 mode scalar
fix h5 some ave/histo 2 3 10 -2 2 4 vx c_ke file h5.txt beyond extra ave running mode vector overwrite title1 "" title2 "# x"
fix h6 all ave/histo 2 3 10 0 20 4 c_t file h6.txt mode vector start 20
fix h8 all ave/histo 10 2 20 0 10 4 f_a[1] f_a[2] file h8.txt mode vector
fix hw all ave/histo/weight 2 3 10 0 2 4 c_ke c_ke file h4.txt mode vector
thermo_style custom step temp f_h[1] f_h[1][2] f_h[1][3] f_h2[2] f_h2[3] f_h3[4] f_hw[1]
dump d all custom 10 dump.txt id f_a[1] f_a[2] f_a[3] f_a[4] f_a[5] f_a1
dump_modify d sort id
""",
    "ave/correlate": """
fix k all ave/correlate 2 3 10 c_t c_t[1] file k1.txt type auto/upper ave running prefactor 2.0
fix k2 all ave/correlate 2 3 10 c_t c_t[1] c_t[2] file k2.txt type full
fix k3 all ave/correlate 2 5 10 c_t c_t[1] c_t[2] file k3.txt type first ave running overwrite start 7
fix k4 all ave/correlate 2 4 8 c_t c_t[1] c_t[2] file k4.txt type lower title1 a title2 b title3 c
fix k5 all ave/correlate 5 2 10 c_t file k5.txt
fix kl all ave/correlate/long 2 10 c_t c_t[1] file kl.txt type auto nlen 4 ncount 2 ncorr 2
fix kl2 all ave/correlate/long 1 10 c_t c_t[1] file kl2.txt type full nlen 6 ncount 3 ncorr 4 overwrite
fix kl3 all ave/correlate/long 1 10 c_t c_t[1] file kl3.txt
thermo_style custom step temp f_k[1][3] f_k[2][4] f_k2[3][1] f_k2[3][2] f_k2[2][11]
""",
    "store": """
fix s0 all store/state 0 x y zu id type vx vy ix xs ysu
fix s1 some store/state 10 x v_ax vz xu com yes
fix s2 some store/state 0 c_ke
fix s3 some store/state 0 c_ke c_s[2]
fix sf all store/force
fix sfs some setforce 0 0 NULL
fix sf2 some store/force
dump d1 all custom 10 dump1.txt id f_s0[1] f_s0[2] f_s0[3] f_s0[4] f_s0[5] f_s0[6] f_s0[7] f_s0[8] f_s0[9] f_s0[10]
dump_modify d1 sort id
dump d2 all custom 10 dump2.txt id f_s1[1] f_s1[2] f_s1[3] f_s1[4] f_s2 f_s3[1] f_s3[2]
dump_modify d2 sort id
dump d3 all custom 10 dump3.txt id f_sf[1] f_sf[2] f_sf[3] f_sf2[1] f_sf2[3]
dump_modify d3 sort id
""",
    "ave/chunk": """
compute cx all chunk/atom bin/1d x lower 0.25
compute cy all chunk/atom bin/1d y lower 0.25 units box
compute cxy all chunk/atom bin/2d x lower 0.5 y lower 0.5 units reduced
compute cty all chunk/atom type
variable idm atom id%5
compute ccom all chunk/atom v_idm compress yes nchunk every ids every
compute csp all chunk/atom bin/1d x lower 0.5 nchunk every
compute tb all temp/com
fix ch all ave/chunk 2 3 10 cx vx density/number density/mass temp c_ke file ch1.txt
fix ch2 all ave/chunk 2 3 10 cy vx temp norm sample ave running file ch2.txt format " %10.4f"
fix ch3 all ave/chunk 2 3 10 cxy density/number temp vx norm none ave window 3 file ch3.txt
fix ch4 some ave/chunk 5 2 10 cty mass c_s[1] v_ax temp adof 2.5 cdof 1.0 file ch4.txt title1 "" title3 "# q"
fix ch5 all ave/chunk 5 2 10 ccom density/number temp fx file ch5.txt ave running overwrite
fix ch6 all ave/chunk 2 3 10 csp temp vx file ch6.txt bias tb
thermo_style custom step temp f_ch[1][3] f_ch[2][4] f_ch4[1][4] f_ch5[2][3]
""",
    "property/atom": """
fix p1 all property/atom d_a i_b d2_c 2 mol
fix p2 all property/atom q ghost yes writedata no
set atom 3*7 d_a 3.25 i_b 4 d2_c[2] 7.5 mol 5 charge 0.25
set atom 2 d_a v_ax
variable x atom d_a+i_b+d2_c[2]
variable y equal d_a[4]+i_b[5]
dump d all custom 10 dump.txt id mol q d_a i_b d2_c[1] d2_c[2] v_x
dump_modify d sort id
thermo_style custom step temp v_y
""",
    "controller": """
variable c internal 1.5
fix k all controller 5 0.7 0.5 0.02 0.3 c_t 1.0 c
variable p equal pe
variable c2 internal 0.0
fix k2 all controller 10 1.0 0.5 0.02 0.3 v_p -5 c2
variable cc equal v_c
variable cc2 equal v_c2
thermo_style custom step temp pe v_cc v_cc2
run 20
thermo_style custom step temp pe v_cc f_k[1] f_k[2] f_k[3] v_cc2
""",
    "ave/moments": """
fix m all ave/moments 2 5 10 c_t v_v mean stddev variance skew kurtosis
fix m2 all ave/moments 2 4 20 c_t kurtosis mean history 3
fix m3 all ave/moments 2 4 10 c_t skew start 15
fix m4 all ave/moments 1 12 5 c_t mean variance history 3
fix m5 all ave/moments 2 20 10 c_thermo_pe mean start 15
fix m6 all ave/moments 1 2 2 c_t mean
thermo_style custom step f_m4[1] f_m4[2][2] f_m4[1][3] f_m5[1] f_m5[1][1] f_m6[1]
run 33
thermo_style custom step temp f_m[1] f_m[2] f_m[3] f_m[4] f_m[5] f_m[6] f_m[7] f_m2[1] f_m2[2] f_m2[1][2] f_m2[2][3] f_m3[1]
""",
    "adapt": """
variable e equal ramp(1.0,1.3)
variable f equal 1.0+0.002*step
fix ad all adapt 2 pair lj/cut epsilon * * v_e
fix ad2 all adapt 5 pair lj/cut sigma 1 * v_f scale yes reset yes
dump d all custom 10 dump.txt id x vx fx
dump_modify d sort id
run 10 start 0 stop 40
""",
}
# words after ``fix x all`` and what the message must have
REFUSED = {
    "ave/time 2 3 10": "at least one value", "ave/time 2 3": "needs 3 values", "ave/time 3 2 10 c_t": "multiple of Nevery",
    "ave/time 2 6 10 c_t": "Nfreq 10 must be", "ave/time 2 3 10 c_tt": "no compute tt", "ave/time 2 3 10 c_t[7]": "no element",
    "ave/time 2 3 10 c_ke": "does not give one number", "ave/time 2 3 10 c_t[1] mode vector": "does not give a vector",
    "ave/time 2 3 10 c_t foo 1": "unknown keyword 'foo'", "ave/time 2 3 10 c_t ave twice": "expected one of",
    "ave/time 2 3 10 c_t off 2": "there are 1 values", "ave/time 2 3 10 c_t overwrite": "ave running",
    "ave/time 2 3 10 c_t file no/such/folder": "cannot write", "ave/time 2 3 10 c_t ave window 0": "at least 1",
    "ave/time 2 3 10 c_t c_thermo_pe[1]": "does not give one number", "vector 5": "needs 2 values", "vector 0 c_t": "at least 1",
    "vector 5 c_t nmax 0": "at least 1", "vector 5 c_t c_t[1]": "cannot be in one array", "print 10": "needs 2 values",
    "print 0 hello": "at least 1", "print 10 hello screen maybe": "yes or no", "print 10 hello files x": "did you mean file",
    "ave/atom 2 3 10": "needs 4 values", "ave/atom 2 3 10 vq": "no value", "ave/atom 2 3 10 c_t": "value for each atom",
    "ave/histo 2 3 10 0 5 5 c_ke": "mode vector", "ave/histo 2 3 10 5 0 5 c_t": "below hi", "ave/histo 2 3 10 0 5 0 c_t": "1 bin",
    "ave/histo 2 3 10 0 5 5 c_ke c_t mode vector": "all per atom or all local", "ave/histo/weight 2 3 10 0 5 5 c_t": "two values",
    "ave/correlate 2 9 10 c_t": "Nevery \\* Nrepeat", "ave/correlate 2 3 10 c_t type upper": "two values",
    "ave/correlate 2 3 10 c_t type all": "expected one of", "ave/correlate/long 2 10 c_t nlen 3 ncount 2": "multiple of ncount",
    "ave/chunk 2 3 10 t vx": "not chunk/atom", "ave/chunk 2 3 10 none vx": "no compute none", "property/atom": "at least one property",
    "property/atom foo": "unknown", "property/atom d2_c": "columns", "property/atom d2_c 0": "at least 1", "property/atom i_a d_a": "twice",
    "property/atom d_a ghost": "yes or no",
    "adapt 1": "at least one", "adapt 1 pair lj/cut epsilon 1": "needs 5 values", "adapt 1 pair lj/cut eps 1 1 v_v": "no coefficient 'eps'",
    "adapt 1 pair lj/cutt epsilon 1 1 v_v": "no pair style", "adapt 1 pair lj/cut epsilon 1 3 v_v": "valid range",
    "adapt 1 pair lj/cut epsilon 1 1 2.0": "v_name", "adapt 1 kspace": "needs 1 value", "adapt 1 atom charge v_v": "no charges",
    "adapt -1 pair lj/cut epsilon 1 1 v_v": "negative", "controller 5 1 1 1 1 c_t 1": "needs 8 values",
    "controller 0 1 1 1 1 c_t 1 c": "undefined variable c", "controller 5 1 1 1 1 c_t 1 v": "internal",
    "ave/moments 2 3 10 c_t": "needs 5 values", "ave/moments 2 3 10 c_t men": "unknown keyword 'men'",
    "ave/moments 2 3 10 c_t mean history 0": "at least 1", "ave/moments 3 3 10 c_t mean": "must be a multiple of Nevery 3",
    "ave/moments 2 3 10 c_t[1][2] mean": "element of an array", "ave/moments 2 3 10 c_t c_thermo_pe mean": "cannot be in one array",
    "ave/spatial 2 3 10 vx 1 2 3": "dim origin delta",
    "ave/spatial 2 3 10 x lower 0.5 temp": "unknown keyword 'temp'", "ave/spatial 2 3 10 x lower 0.5 vx overwrite": "ave running",
    "store/state 0": "needs 2 values", "store/state 0 xx": "unknown value 'xx'", "store/state -1 x": "negative",
    "store/force 1": "no arguments",
}
