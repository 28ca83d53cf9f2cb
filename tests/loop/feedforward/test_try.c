#include "tune_bench.h"
void setUp(void){memory_port_erase_all();}
void tearDown(void){plant_power_off();}
static void show(void){ ask_ok("block 1"); for(unsigned k=0;k<n_reply;k++) if(strstr(reply[k]," = ")&&!strstr(reply[k],"verb")) printf("%s;",reply[k]+1); printf("\n"); }
static const char* E(const char*n,const char*d){return getenv(n)?getenv(n):d;}
static void one(void){
  char line[80]; int regime=atoi(E("REGIME","1")); int staged=strcmp(E("METHOD","joint"),"joint")!=0;
  tune_begin(FEEDFORWARD,(uint64_t)atoi(E("SEED","7")),1);
  set_parameter("regime",regime);
  snprintf(line,sizeof line,"set block1.method %s",E("METHOD","joint"));ask_ok(line);
  if(getenv("SET")){char b[400];snprintf(b,sizeof b,"%s",getenv("SET"));for(char*p=strtok(b,";");p;p=strtok(NULL,";")){snprintf(line,sizeof line,"set %s",p);ask_ok(line);}}
  tune_seconds(1200);
  printf("before: %.4f\n",mean_square(1200));
  if(!getenv("NOTUNE")) {
  course.quiet = staged;
  ask_ok("block 1 tune");
  for(int k=0;k<1200;k++){ tune_seconds(20); int st=tune_value("stage"); if(st==DISTURBANCE) course.quiet=false; if(k%20==0&&getenv("V"))show(); if(st==RUNS||st==IDLE)break; }
  tune_seconds(1200);
  show();
  }
  printf("with: %.4f\n",mean_square(1200));
  if(getenv("EVENT")){ const char*e=getenv("EVENT"); if(strchr(e,'.')) plant_event(e); else { char n[20]; int v; sscanf(e,"%19[^=]=%d",n,&v); set_parameter(n,v);} }
  course.quiet=false;
  int N=atoi(E("N","40"));
  for(int k=0;k<N;k++){ double m=mean_square(300); printf("%5d %.4f st %d v %d does %.1f k %.3f tried %d\n",(k+1)*300,m,tune_value("stage"),tune_value("verdict"),value_of(1,"does"),value_of(1,"found_k"),tune_value("tried")); }
  ask_ok("list ff1"); for(unsigned k=0;k<n_reply;k++) if(strstr(reply[k],"gain")||strstr(reply[k],"lead")) printf("%s\n",reply[k]);
  ask_ok("events"); for(unsigned k=0;k<n_reply;k++) if(strstr(reply[k],"BLOCK")) printf("%s\n",reply[k]);
}
int main(void){UNITY_BEGIN();RUN_TEST(one);return UNITY_END();}
