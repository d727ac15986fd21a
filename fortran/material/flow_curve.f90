!> Flow stress of a metal: how it hardens with plastic strain, and what the rate of strain adds.
!>
!> One function serves every law: sigma(eps, rate) with its slopes. A law is rate-independent
!> (sigma does not look at the rate), of the Perzyna kind (an overstress above a threshold that
!> hardens), or purely viscous (Norton-Hoff: no threshold). The radial return asks for nothing else.
!>
!> Hardening by name, eps the accumulated plastic strain:
!>   TABLE      linear between points, constant beyond the last one
!>   SWIFT      K (eps0 + eps)^n
!>   HOLLOMON   K (eps0 + eps)^n with eps0 = (Y/K)^(1/n), constant: K eps^n in the total strain at
!>              yield; beyond, without the elastic strain that hardening adds
!>   VOCE       S - (S - Y) exp(-d eps) + H eps
!>   LINEAR     Y + H eps (Voce without its exponential)
!> Rates: factor 1 + (rate/D)^(1/p) (power law of Cowper and Symonds), and a viscous part
!> K sqrt(3)^(m+1) rate^m (Norton-Hoff: s = 2 K (sqrt(3) rate)^(m-1) strain rate; lecture G).
module lopin_flow_curve
   use lopin_kinds, only : wp
   implicit none
   private
   public :: flow_type, hardening_of, flow_stress, flow_step, flows, table_flow, swift_flow, &
      & hollomon_flow, voce_flow, linear_flow, is_viscous, give_viscosity, least_slope, table_end, &
      & flow_at

   type :: hardenings
      integer :: none = 0, table = 1, swift = 2, voce = 3
   end type hardenings
   type(hardenings), parameter :: hardening_of = hardenings()

   !> A trial stress beyond yield by no more than this share is rounding: the point is at rest.
   real(wp), parameter :: rest = 1.0e-9_wp

   type :: flow_type
      integer :: hardening = 0                !! hardening_of%...; none: no threshold
      real(wp) :: constant(4) = 0.0_wp        !! Swift: K, eps0, n; Voce: S, Y, d, H
      real(wp), allocatable :: strain(:)      !! table: plastic strains, increasing from 0
      real(wp), allocatable :: stress(:)      !! table: flow stresses > 0 [stress]
      real(wp), allocatable :: temperature(:) !! increasing, with a table for each behind the other;
                                              !! ask flow_at for the curve of one of them
      integer, allocatable :: first(:)        !! (n+1) where the table of each temperature begins
      real(wp) :: rate = 0.0_wp               !! D of the power law [1/time]; 0: no such factor
      real(wp) :: power = 1.0_wp              !! p of the power law
      real(wp) :: consistency = 0.0_wp        !! K of Norton-Hoff [stress time^m]; 0: no such part
      real(wp) :: sensitivity = 1.0_wp        !! m of Norton-Hoff, in (0, 1]
      logical :: rigid = .false.              !! no elastic deviator: flow alone
      real(wp) :: usual = 1.0_wp              !! rigid: a rate as it will meet [1/time]
   end type flow_type

   !> A slope without bound, which may still be divided by a time.
   real(wp), parameter :: infinite = 1.0e154_wp

contains

   !> Linear between points of a table; a single point is perfect plasticity.
   pure function table_flow(strain, stress) result(flow)
      real(wp), intent(in) :: strain(:)       !! from 0, increasing
      real(wp), intent(in) :: stress(:)       !! > 0 [stress]
      type(flow_type) :: flow
      flow%hardening = hardening_of%table
      allocate (flow%strain, source=strain)
      allocate (flow%stress, source=stress)
   end function table_flow

   !> Swift's hardening: k (eps0 + eps)^n.
   pure function swift_flow(k, eps0, n) result(flow)
      real(wp), intent(in) :: k               !! > 0 [stress]
      real(wp), intent(in) :: eps0            !! > 0 [-]
      real(wp), intent(in) :: n               !! in (0, 1]
      type(flow_type) :: flow
      flow%hardening = hardening_of%swift
      flow%constant(:3) = [k, eps0, n]
   end function swift_flow

   pure function hollomon_flow(k, n, yield) result(flow)
      real(wp), intent(in) :: k               !! > 0 [stress]
      real(wp), intent(in) :: n               !! in (0, 1]
      real(wp), intent(in) :: yield           !! > 0: where K eps^n begins [stress]
      type(flow_type) :: flow
      flow = swift_flow(k, (yield/k)**(1.0_wp/n), n)
   end function hollomon_flow

   pure function voce_flow(saturation, yield, decay, slope) result(flow)
      real(wp), intent(in) :: saturation      !! >= yield [stress]
      real(wp), intent(in) :: yield           !! > 0 [stress]
      real(wp), intent(in) :: decay           !! > 0 [-]
      real(wp), intent(in) :: slope           !! >= 0 [stress]
      type(flow_type) :: flow
      flow%hardening = hardening_of%voce
      flow%constant = [saturation, yield, decay, slope]
   end function voce_flow

   pure function linear_flow(yield, slope) result(flow)
      real(wp), intent(in) :: yield           !! > 0 [stress]
      real(wp), intent(in) :: slope           !! >= 0 [stress]
      type(flow_type) :: flow
      flow = voce_flow(yield, yield, 0.0_wp, slope)
   end function linear_flow

   !> Add the viscous stress of Norton and Hoff to a law, which becomes its threshold.
   pure subroutine give_viscosity(flow, consistency, sensitivity)
      type(flow_type), intent(inout) :: flow
      real(wp), intent(in) :: consistency     !! K > 0 [stress time^m]
      real(wp), intent(in) :: sensitivity     !! m in (0, 1]
      flow%consistency = consistency
      flow%sensitivity = sensitivity
   end subroutine give_viscosity

   !> The curve of one temperature: stresses go linearly from table to table, and stay beyond the
   !> first and the last of them.
   pure function flow_at(flow, temperature) result(one)
      type(flow_type), intent(in) :: flow
      real(wp), intent(in) :: temperature
      type(flow_type) :: one
      real(wp) :: share
      integer :: k, n

      one = flow
      if (.not. allocated(flow%temperature)) return
      deallocate (one%temperature, one%first)
      n = size(flow%temperature)
      k = min(max(count(flow%temperature <= temperature), 1), max(1, n - 1))
      share = 0.0_wp
      if (n > 1) share = min(1.0_wp, max(0.0_wp, (temperature - flow%temperature(k)) &
         & /(flow%temperature(k + 1) - flow%temperature(k))))
      associate (p => flow%first(k), q => flow%first(k + 1))
         if (.not. share > 0.0_wp) then
            one%strain = flow%strain(p:q - 1)
            one%stress = flow%stress(p:q - 1)
         else
            call mix_tables(flow%strain(p:q - 1), flow%stress(p:q - 1), &
               & flow%strain(q:flow%first(k + 2) - 1), flow%stress(q:flow%first(k + 2) - 1), &
               & share, one%strain, one%stress)
         end if
      end associate
   end function flow_at

   !> Two tables of increasing strains become one that has the strains of both.
   pure subroutine mix_tables(e1, s1, e2, s2, share, strain, stress)
      real(wp), intent(in) :: e1(:), s1(:), e2(:), s2(:)
      real(wp), intent(in) :: share          !! of the second, in [0, 1]
      real(wp), allocatable, intent(inout) :: strain(:), stress(:)
      real(wp) :: e(size(e1) + size(e2)), s(size(e)), next
      integer :: i, j, n

      i = 1
      j = 1
      n = 0
      do while (i <= size(e1) .or. j <= size(e2))
         next = huge(next)
         if (i <= size(e1)) next = e1(i)
         if (j <= size(e2)) next = min(next, e2(j))
         if (i <= size(e1)) then
            if (e1(i) <= next) i = i + 1
         end if
         if (j <= size(e2)) then
            if (e2(j) <= next) j = j + 1
         end if
         n = n + 1
         e(n) = next
         s(n) = (1.0_wp - share)*in_table(e1, s1, next) + share*in_table(e2, s2, next)
      end do
      strain = e(:n)
      stress = s(:n)
   end subroutine mix_tables

   !> Value of a table, constant beyond its end.
   pure real(wp) function in_table(strain, stress, at) result(value)
      real(wp), intent(in) :: strain(:), stress(:), at
      integer :: k

      k = count(strain <= at)
      if (k == size(strain)) then
         value = stress(k)
      else
         value = stress(k) + (stress(k + 1) - stress(k)) &
            & *(at - strain(k))/(strain(k + 1) - strain(k))
      end if
   end function in_table

   !> The lowest slope of the threshold, d stress/d strain; negative where the law softens.
   pure real(wp) function least_slope(flow) result(least)
      type(flow_type), intent(in) :: flow
      integer :: n

      least = 0.0_wp
      select case (flow%hardening)
      case (hardening_of%table)
         do n = 2, size(flow%strain)
            if (flow%strain(n) > flow%strain(n - 1)) least = min(least, (flow%stress(n) &
               & - flow%stress(n - 1))/(flow%strain(n) - flow%strain(n - 1)))
         end do
      case (hardening_of%voce)
         least = min(0.0_wp, flow%constant(4) + flow%constant(3)*(flow%constant(1) &
            & - flow%constant(2)))
      end select
   end function least_slope

   !> Plastic strain at which a table ends while it still rises or falls; huge for the other laws.
   pure real(wp) function table_end(flow) result(last)
      type(flow_type), intent(in) :: flow
      integer :: n

      last = huge(1.0_wp)
      if (flow%hardening /= hardening_of%table) return
      do n = 2, size(flow%strain)
         ! The last line of a table, of one temperature or of all.
         if (n < size(flow%strain)) then
            if (flow%strain(n + 1) > flow%strain(n)) cycle
         end if
         if (flow%strain(n) > flow%strain(n - 1) .and. abs(flow%stress(n) - flow%stress(n - 1)) &
            & > 0.0_wp) last = min(last, flow%strain(n))
      end do
   end function table_end

   !> A law whose stress looks at the rate.
   pure logical function is_viscous(flow)
      type(flow_type), intent(in) :: flow
      is_viscous = flow%rate > 0.0_wp .or. flow%consistency > 0.0_wp
   end function is_viscous

   !> There is a law at all.
   pure logical function flows(flow)
      type(flow_type), intent(in) :: flow
      flows = flow%hardening /= hardening_of%none .or. flow%consistency > 0.0_wp
   end function flows

   !> Threshold of flow and its slope.
   pure subroutine threshold(flow, strain, stress, slope)
      type(flow_type), intent(in) :: flow
      real(wp), intent(in) :: strain
      real(wp), intent(out) :: stress, slope
      integer :: k, n

      stress = 0.0_wp
      slope = 0.0_wp
      select case (flow%hardening)
      case (hardening_of%swift)
         stress = flow%constant(1)*(flow%constant(2) + strain)**flow%constant(3)
         slope = flow%constant(3)*stress/(flow%constant(2) + strain)
      case (hardening_of%voce)
         slope = (flow%constant(1) - flow%constant(2))*exp(-flow%constant(3)*strain)
         stress = flow%constant(1) - slope + flow%constant(4)*strain
         slope = flow%constant(3)*slope + flow%constant(4)
      case (hardening_of%table)
         n = size(flow%strain)
         if (allocated(flow%first)) n = flow%first(2) - 1
         k = 1
         do while (k < n)
            if (strain < flow%strain(k + 1)) exit
            k = k + 1
         end do
         stress = flow%stress(k)
         if (k == n) return
         slope = (flow%stress(k + 1) - stress)/(flow%strain(k + 1) - flow%strain(k))
         stress = stress + slope*(strain - flow%strain(k))
      end select
   end subroutine threshold

   !> Flow stress and its slopes with plastic strain and with the rate.
   pure subroutine flow_stress(flow, strain, rate, stress, slope, rate_slope)
      type(flow_type), intent(in) :: flow
      real(wp), intent(in) :: strain          !! accumulated plastic strain >= 0
      real(wp), intent(in) :: rate            !! of it, >= 0 [1/time]
      real(wp), intent(out) :: stress         !! [stress]
      real(wp), intent(out) :: slope          !! [stress]
      real(wp), intent(out) :: rate_slope     !! 1e154 where it is infinite [stress time]
      real(wp) :: part, factor

      call threshold(flow, strain, stress, slope)
      rate_slope = 0.0_wp
      if (flow%rate > 0.0_wp) then
         factor = (rate/flow%rate)**(1.0_wp/flow%power)
         rate_slope = slope_of_power(stress*factor, rate, 1.0_wp/flow%power, stress/flow%rate)
         stress = stress*(1.0_wp + factor)
         slope = slope*(1.0_wp + factor)
      end if
      if (flow%consistency > 0.0_wp) then
         part = flow%consistency*sqrt(3.0_wp)**(flow%sensitivity + 1.0_wp)
         factor = part*rate**flow%sensitivity
         rate_slope = rate_slope + slope_of_power(factor, rate, flow%sensitivity, part)
         stress = stress + factor
      end if
   end subroutine flow_stress

   !> Slope of c x^m whose value is given.
   pure real(wp) function slope_of_power(value, x, m, c) result(slope)
      real(wp), intent(in) :: value, x, m, c
      slope = c
      if (x > 0.0_wp .and. m*value/infinite < x) then
         slope = m*value/x
      else if (x > 0.0_wp .or. m < 1.0_wp) then
         slope = infinite
      end if
   end function slope_of_power

   !> The plastic strain of one increment: trial - 3 G step = sigma(strain + step, step/dt).
   !>
   !> The left side falls and the right side rises (a law may soften by less than 3 G): one root,
   !> by Newton inside a bracket that only shrinks.
   pure subroutine flow_step(flow, shear, trial, strain, dt, step, stress, slope)
      type(flow_type), intent(in) :: flow
      real(wp), intent(in) :: shear           !! G > 0 [stress]
      real(wp), intent(in) :: trial           !! von Mises stress without flow >= 0 [stress]
      real(wp), intent(in) :: strain          !! accumulated plastic strain before
      real(wp), intent(in) :: dt              !! > 0 [time]
      real(wp), intent(out) :: step           !! >= 0; 0: elastic
      real(wp), intent(out) :: stress         !! flow stress after it [stress]
      real(wp), intent(out) :: slope          !! d stress/d step [stress]
      integer, parameter :: most = 100
      real(wp) :: low, high, value, rate_slope, next
      logical :: viscous
      integer :: i

      step = 0.0_wp
      call threshold(flow, strain, stress, slope)
      if (trial <= stress*(1.0_wp + rest)) return
      low = 0.0_wp
      high = trial/(3.0_wp*shear)
      viscous = is_viscous(flow)
      if (viscous) step = 0.5_wp*bound_of_rate(flow, trial, dt, high)
      do i = 1, most
         if (viscous) then
            call flow_stress(flow, strain + step, step/dt, stress, slope, rate_slope)
            slope = slope + rate_slope/dt
         else if (i > 1) then
            call threshold(flow, strain + step, stress, slope)
         end if
         value = trial - 3.0_wp*shear*step - stress
         if (value > 0.0_wp) low = step
         if (value <= 0.0_wp) high = step
         next = step + value/(3.0_wp*shear + slope)
         if (.not. (next >= low .and. next <= high)) next = 0.5_wp*(low + high)
         if (abs(next - step) <= 2.0_wp*epsilon(step)*next) exit
         step = next
      end do
      stress = trial - 3.0_wp*shear*step
   end subroutine flow_step

   !> Where the viscous part alone would carry the trial stress: no step is longer.
   pure real(wp) function bound_of_rate(flow, trial, dt, most) result(bound)
      type(flow_type), intent(in) :: flow
      real(wp), intent(in) :: trial, dt, most
      real(wp) :: part

      bound = most
      if (.not. flow%consistency > 0.0_wp) return
      part = flow%consistency*sqrt(3.0_wp)**(flow%sensitivity + 1.0_wp)
      if (log(trial/part)/flow%sensitivity < log(most/dt)) &
         & bound = dt*(trial/part)**(1.0_wp/flow%sensitivity)
   end function bound_of_rate
end module lopin_flow_curve
