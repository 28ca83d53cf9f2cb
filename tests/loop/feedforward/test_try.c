#include "tune_bench.h"
void setUp(void){memory_port_erase_all();}
void tearDown(void){plant_power_off();}
static void show(void){ ask_ok("block 1"); for(unsigned k=0;k<n_reply;k++) if(strstr(reply[k]," = ")) printf("%s;",reply[k]+1); printf("\n"); }
static void one(void){
  const char *m=getenv("METHOD"); int regime=getenv("REGIME")?atoi(getenv("REGIME")):1; char line[80];
  tune_begin(FEEDFORWARD,7,getenv("NOISE")?atof(getenv("NOISE")):1);
  set_parameter("regime",regime);
  if(m){snprintf(line,sizeof line,"set block1.method %s",m);ask_ok(line);}
  if(getenv("SET")){snprintf(line,sizeof line,"set %s",getenv("SET"));ask_ok(line);}
  tune_seconds(1200);
  printf("without: %.4f\n",mean_square(1200));
  course.quiet = m!=NULL && strcmp(m,"joint")!=0;
  ask_ok("block 1 tune");
  int last=-1;
  for(int k=0;k<1200;k++){ tune_seconds(20); int st=tune_value("stage"); if(st==DISTURBANCE) course.quiet=false; if(st!=last||k%100==0){printf("t=%d ",k*20);show();last=st;} if(st==RUNS||st==IDLE)break; }
  printf("with: %.4f\n",mean_square(1200)); printf("with: %.4f\n",mean_square(1200)); show();
  for (unsigned k = 0; k < n_reply; k++) (void)k;
  ask_ok("list ff1"); for(unsigned k=0;k<n_reply;k++) printf("%s\n",reply[k]);
  ask_ok("events"); for(unsigned k=0;k<n_reply;k++) printf("%s\n",reply[k]);
}
int main(void){UNITY_BEGIN();RUN_TEST(one);return UNITY_END();}
