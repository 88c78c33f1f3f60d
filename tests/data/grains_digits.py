"""The law of grains in sixteen digits, by quadrature of the definition over the azimuth, cut at its kinks (mpmath, 40
digits). The closed forms of src/theory/grains.rs are not used here.

    python3 grains_digits.py ROWS.csv grains_digits.csv     ROWS.csv: coverage and angles in its first seven columns
"""
import csv, sys
from mpmath import mp, mpf, sin, cos, sqrt, acos, atan2, pi, quad, log, exp, findroot
mp.dps = 40
def reach2(s, c, z, psi):
    k = s*cos(psi)
    a, b, e = 1-k*k, k*c*z, z*z*s*s-1
    r = (-b+sqrt(b*b-a*e))/a
    return r*r
def area(s,c,z):
    if z >= s: return mpf(0)
    seg = lambda u: acos(u)-u*sqrt(1-u*u)
    return seg(z/s)/c-(1-z*z)*seg(z*c/(s*sqrt(1-z*z)))
def common(si,ci,so,co,turn,z):
    if z >= min(si,so): return mpf(0)
    r02 = 1-z*z
    ai = acos(z*ci/(si*sqrt(r02))); ao = acos(z*co/(so*sqrt(r02)))
    lo, hi = max(-ai,turn-ao), min(ai,turn+ao)
    if lo >= hi: return mpf(0)
    # kinks by bisection of the difference on a fine grid
    d = lambda p: reach2(si,ci,z,p)-reach2(so,co,z,p-turn)
    n = 400; marks=[lo]
    ps=[lo+(hi-lo)*mpf(k)/n for k in range(n+1)]; ds=[d(p) for p in ps]
    for k in range(n):
        if ds[k]*ds[k+1]<0:
            a,b=ps[k],ps[k+1]; fa=ds[k]
            for _ in range(120):
                m=(a+b)/2; fm=d(m)
                if fa*fm<=0: b=m
                else: a,fa=m,fm
            marks.append((a+b)/2)
    marks.append(hi)
    # near the axis the ellipse is 1/c long: cut there
    for cut in [mpf(0), turn]+[x+s*w for x in (mpf(0),turn) for s in (-1,1) for w in (ci,co,ci*8,co*8)]:
        if lo<cut<hi: marks.append(cut)
    marks=sorted(set(marks))
    return quad(lambda p: (min(reach2(si,ci,z,p),reach2(so,co,z,p-turn))-r02)/2, marks)
def row(tau,ax,ay,ti,pi_,to,po):
    rad=lambda x: mpf(x)*pi/180
    w=lambda t,p:(sin(rad(t))*cos(rad(p)),sin(rad(t))*sin(rad(p)),cos(rad(t)))
    tau,ax,ay=mpf(tau),mpf(ax),mpf(ay)
    i,o=w(ti,pi_),w(to,po); h=[a+b for a,b in zip(i,o)]
    m=(h[0]/ax,h[1]/ay,h[2]); z=m[2]/sqrt(sum(x*x for x in m))
    can=lambda v:(ax*v[0],ay*v[1],v[2])
    def sc(v): 
        v=can(v); l=sqrt(v[0]**2+v[1]**2+v[2]**2); return sqrt(v[0]**2+v[1]**2)/l, v[2]/l, v
    si,ci,vi=sc(i); so,co,vo=sc(o)
    turn=abs(atan2(vi[0]*vo[1]-vi[1]*vo[0], vi[0]*vo[0]+vi[1]*vo[1]))
    lam=-log(1-tau)/pi
    Ai,Ao,C=area(si,ci,z),area(so,co,z),common(si,ci,so,co,turn,z)
    g2,prod=exp(-lam*(Ai+Ao-C)),exp(-lam*(Ai+Ao))
    H2=sum(x*x for x in h); q=H2/(m[0]**2+m[1]**2+m[2]**2)
    D=q*q/(pi*ax*ay)*(-log(1-tau))*(1-tau)**(1-z*z)
    f=D*g2/(4*i[2]*o[2])
    return [mp.nstr(x,16) for x in (D,g2,prod,f)]
out=csv.writer(open(sys.argv[2],'w',newline=''))
out.writerow("coverage,alpha_x,alpha_y,theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,D,G2,G1_G1,f".split(","))
rows=[r[:7] for r in list(csv.reader(open(sys.argv[1])))[1:]]
# Extremes: grazing, near back-scatter, tiny and unequal slopes, hardly and nearly full coverage.
rows+= [["0.9","0.5","0.5","89.99","20","60","20"],["0.9","0.5","0.5","89.99","20","89.99","21"],["0.5","1","1","60","0","60.000001","0"],
 ["0.5","1","1","60","0","60","0.0001"],["0.999","10","10","80","0","70","100"],["0.0001","0.5","0.5","80","0","70","100"],
 ["0.5","0.0001","0.0001","89.9","0","89.8","180"],["0.9","0.0001","1","70","90","60","100"],["0.9","10","0.001","70","30","60","40"],["0.9","1","1","89.9","0","1","0"],
 ["0.9","0.5","0.5","60","0","60","0"],["0.9","0.5","0.5","0","0","80","0"],["0.99","1","1","45","0","45","90"], ["0.9","1","1","60","0","60","0"]]
for r in rows: out.writerow(r+row(*r)); 
