!> Flow laws completed and checked against the whole model: yield stress, rates, moduli of rigid
!> solids.
module lopin_settle_flow
   use lopin_kinds, only : wp
   use lopin_error, only : severity
   use lopin_text, only : to_text
   use lopin_model, only : model_type, material_type, prescribed_type
   use lopin_flow_curve, only : flow_type, flow_stress, flow_at, flows, hardening_of, &
      & is_viscous, least_slope
   use lopin_hyperelastic, only : solid_law_type, elastic_constants
   use lopin_block, only : complain
   implicit none
   private
   public :: settle_flow

   !> A rigid solid keeps its volume to the inverse of this: bulk modulus beside the flow stress.
   real(wp), parameter :: keeps_volume = 1.0e6_wp
   !> Shear modulus beside the flow stress that only scales penalties and first guesses.
   real(wp), parameter :: stiff = 100.0_wp

contains

   subroutine settle_flow(model)
      type(model_type), intent(inout) :: model
      integer :: i

      do i = 1, size(model%material)
         associate (material => model%material(i))
            if (material%starts_elastic) then
               call start_on_elastic_line(material%flow, material%young)
               call start_on_elastic_line(material%friction_flow, material%young)
            end if
            call check_threshold(model, material)
            if (flows(material%flow)) then
               call check_softening(model, material)
               if (is_viscous(material%flow)) call check_time(model, material)
            end if
         end associate
         call settle_yield(model, i)
         if (model%material(i)%flow%rigid) call settle_rigid(model, i)
      end do
   end subroutine settle_flow

   !> Hollomon's curve K e^n in the total strain leaves the line E e at Y = (K/E^n)^(1/(1 - n)).
   subroutine start_on_elastic_line(flow, young)
      type(flow_type), intent(inout) :: flow
      real(wp), intent(in) :: young        !! 0: none [stress]

      associate (k => flow%constant(1), n => flow%constant(3))
         if (flow%hardening == hardening_of%none .or. .not. young > 0.0_wp &
            & .or. .not. n < 1.0_wp) return
         flow%constant(2) = ((k/young**n)**(1.0_wp/(1.0_wp - n))/k)**(1.0_wp/n)
      end associate
   end subroutine start_on_elastic_line

   !> A factor on a flow curve needs that curve, and rubber has none.
   subroutine check_threshold(model, material)
      type(model_type), intent(inout) :: model
      type(material_type), intent(in) :: material

      if (material%flow%rate > 0.0_wp .and. material%flow%hardening == hardening_of%none) &
         & call complain(model%log, 'E0203', '*RATE DEPENDENT multiplies a flow curve, which '// &
         & 'material `'//material%name//'` has not', material%viscous_at, &
         & help='add *PLASTIC; *VISCOPLASTIC is a law of its own')
      if (material%potential_at%line > 0 .and. .not. flows(material%flow)) call complain( &
         & model%log, &
         & 'E0203', '*POTENTIAL shapes the yield surface of *PLASTIC, which material `'// &
         & material%name//'` has not', material%potential_at, help='add *PLASTIC')
      if (allocated(material%plastic) .and. material%flow%rigid) call complain(model%log, 'E0108', &
         & 'a rigid solid with a yield surface of its own comes with a later version: material '// &
         & '`'// &
         & material%name//'`', material%viscous_at, help='leave out RIGID, and give *ELASTIC')
      if (allocated(material%damage) .and. .not. flows(material%flow)) call complain(model%log, &
         & 'E0203', '*DAMAGE counts plastic strain, which material `'//material%name//'` has '// &
         & 'none of', material%at, help='add *PLASTIC')
      if (material%has_neo_hooke .and. flows(material%flow)) call complain(model%log, 'E0205', &
         & 'material `'//material%name//'` has *HYPERELASTIC, which does not flow', material%at, &
         & help='metals have *ELASTIC')
   end subroutine check_threshold

   !> Softening solids have no answer that meshes agree on; beyond 3 G they have none at all.
   subroutine check_softening(model, material)
      type(model_type), intent(inout) :: model
      type(material_type), intent(in) :: material
      real(wp) :: least

      least = least_slope(material%flow)
      if (.not. least < 0.0_wp) return
      if (-least >= 1.5_wp*material%young/(1.0_wp + material%poisson) &
         & .and. material%young > 0.0_wp) then
         call complain(model%log, 'E0203', 'the flow curve of material `'//material%name// &
            & '` falls faster ('//to_text(-least, 4)// &
            & ' per strain) than elasticity unloads (3 G)', material%plastic_at)
         return
      end if
      call model%log%say(severity%warning, 'W0324', 'the flow curve of material `'// &
         & material%name//'` falls: strain will gather in a row of elements, and the answer '// &
         & 'depends on the mesh', material%plastic_at, help='there is no cure but a curve that '// &
         & 'does not fall; compare two meshes')
   end subroutine check_softening

   !> A rate needs a real time: the default period of 1 is one by chance.
   subroutine check_time(model, material)
      type(model_type), intent(inout) :: model
      type(material_type), intent(in) :: material
      integer :: s

      do s = 1, size(model%step)
         if (model%step(s)%timed) cycle
         call model%log%say(severity%warning, 'W0323', 'the flow stress of material `'// &
            & material%name//'` depends on the rate of strain, and step '//to_text(s)// &
            & ' has no period: it is 1 by default', material%viscous_at, &
            & help='write the times after *STATIC: initial, period')
         return
      end do
   end subroutine check_time

   !> The one home of the yield stress: of the curve of *PLASTIC before anything is strained or
   !> heated; of a law without threshold the flow stress at the mean rate, from which friction
   !> starts.
   subroutine settle_yield(model, number)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: number
      type(flow_type) :: flow
      real(wp) :: slope, rate_slope

      associate (material => model%material(number))
         flow = initial_curve(model, material%flow)
         if (flows(material%friction_flow)) flow = initial_curve(model, material%friction_flow)
         call flow_stress(flow, 0.0_wp, 0.0_wp, material%yield, slope, rate_slope)
         if (.not. material%yield > 0.0_wp .and. flows(material%flow)) &
            & material%yield = mean_stress(model, number)
      end associate
   end subroutine settle_yield

   !> The curve at the mean temperature before anything is heated.
   type(flow_type) function initial_curve(model, flow) result(curve)
      type(model_type), intent(in) :: model
      type(flow_type), intent(in) :: flow

      curve = flow
      if (allocated(flow%temperature)) curve = flow_at(flow, &
         & sum(model%temperature)/size(model%temperature))
   end function initial_curve

   !> The flow stress at the mean strain and rate of the run [stress].
   real(wp) function mean_stress(model, number) result(stress)
      type(model_type), intent(in) :: model
      integer, intent(in) :: number
      real(wp) :: strain, rate, slope, rate_slope

      call mean_rate(model, number, strain, rate)
      call flow_stress(initial_curve(model, model%material(number)%flow), strain, rate, stress, &
         & slope, rate_slope)
   end function mean_stress

   !> Moduli of a rigid solid follow from its flow stress at the mean rate.
   subroutine settle_rigid(model, number)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: number
      type(solid_law_type) :: law
      real(wp) :: strain, rate, stress

      call mean_rate(model, number, strain, rate)
      stress = mean_stress(model, number)
      associate (material => model%material(number))
         material%flow%usual = rate
         law%bulk = keeps_volume*stress
         if (material%has_elastic) law%bulk = material%young/(3.0_wp*(1.0_wp &
            & - 2.0_wp*material%poisson))
         law%shear = min(stiff*stress, law%bulk)
         call elastic_constants(law, material%young, material%poisson)
      end associate
   end subroutine settle_rigid

   !> The largest prescribed motion of a step beside the smallest extent of the bodies, per period;
   !> strains of 1 where forces drive.
   subroutine mean_rate(model, number, strain, rate)
      type(model_type), intent(in) :: model
      integer, intent(in) :: number
      real(wp), intent(out) :: strain, rate
      real(wp) :: low(3), high(3), extent, move
      integer :: e, a, s, d

      low = huge(1.0_wp)
      high = -huge(1.0_wp)
      do e = 1, model%mesh%nelement
         if (model%mesh%section(e) == 0) cycle
         if (model%section(model%mesh%section(e))%material /= number) cycle
         do a = 1, count(model%mesh%conn(:, e) > 0)
            d = size(model%mesh%x, 1)
            low(:d) = min(low(:d), model%mesh%x(:, model%mesh%conn(a, e)))
            high(:d) = max(high(:d), model%mesh%x(:, model%mesh%conn(a, e)))
         end do
      end do
      extent = minval(high(:model%mesh%ndim) - low(:model%mesh%ndim))
      strain = 0.0_wp
      rate = 0.0_wp
      do s = 1, size(model%step)
         move = largest_move(model, s)
         if (.not. (move > 0.0_wp .and. extent > 0.0_wp)) cycle
         strain = strain + move/extent
         rate = max(rate, move/extent/model%step(s)%period)
      end do
      if (rate > 0.0_wp) return
      strain = 1.0_wp
      if (size(model%step) > 0) rate = 1.0_wp/minval(model%step%period)
   end subroutine mean_rate

   !> The largest change of a prescribed displacement in a step.
   real(wp) function largest_move(model, s) result(move)
      type(model_type), intent(in) :: model
      integer, intent(in) :: s
      real(wp) :: before, swing
      integer :: i

      move = 0.0_wp
      do i = 1, size(model%step(s)%prescribed)
         associate (now => model%step(s)%prescribed(i))
            if (now%dof > 3) cycle
            swing = 1.0_wp
            if (now%amplitude > 0) swing = maxval(abs(model%amplitude(now%amplitude)%value))
            before = 0.0_wp
            if (s > 1) before = value_of(model%step(s - 1)%prescribed, now%node, now%dof)
            move = max(move, abs(swing*now%value - before))
         end associate
      end do
   end function largest_move

   !> What is prescribed to a degree of freedom; 0: nothing.
   pure real(wp) function value_of(prescribed, node, dof) result(value)
      type(prescribed_type), intent(in) :: prescribed(:)
      integer, intent(in) :: node, dof
      integer :: k

      value = 0.0_wp
      do k = 1, size(prescribed)
         if (prescribed(k)%node == node .and. prescribed(k)%dof == dof) value = prescribed(k)%value
      end do
   end function value_of
end module lopin_settle_flow
