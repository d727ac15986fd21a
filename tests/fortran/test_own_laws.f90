!> What a caller writes alone holds like what the library has: methods of enforcement, a law of
!> friction and a yield surface of module own_laws in patch, tangent and identity tests.
program test_own_laws
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, log_type
   use lopin_clock, only : clock_type
   use lopin_deck, only : deck_type, read_deck_text
   use lopin_model, only : model_type
   use lopin_build_model, only : new_model
   use lopin_recorder, only : recorder_holder_type
   use lopin_recorder_last, only : last_recorder_type
   use lopin_run_analysis, only : run_analysis
   use lopin_report, only : summary_type, frame_type, verdict_words
   use lopin_enforcement, only : enforcement_type, copy_method
   use lopin_enforcement_factory, only : new_enforcement
   use lopin_friction, only : friction_type, condition_type, law_of
   use lopin_friction_return, only : return_to_disc
   use lopin_flow_curve, only : flow_type, voce_flow
   use lopin_plastic_return, only : plastic_type, plastic_past_type, plastic_answer_type, &
      & return_to_surface
   use contact_scenes, only : box
   use point_scenes, only : point_scene_type, new_point_scene, look, random
   use own_laws, only : stress_recorder_type, spring_type, compliant_type, tanh_radius, &
      & coulomb_radius, quartic_type
   use check, only : test, close_to, is_true, finish
   implicit none

   character(len=1), parameter :: nl = achar(10)
   character(len=8), parameter :: points(4) = [character(len=8) :: 'line2', 'quad4', 'circle', &
      & 'sphere']
   integer :: i, n

   call random_seed(size=i)
   call random_seed(put=[(4711*n, n=1, i)])
   call tangents_of_points()
   call slopes_of_the_radius()
   call tangent_of_the_surface()
   call patch_by_methods()
   call a_share_of_the_slope()
   call friction_as_coulomb()
   call friction_of_its_own()
   call surface_as_von_mises()
   call surface_of_its_own()
   call finish()

contains

   subroutine tangents_of_points()
      type(point_scene_type) :: scene
      integer :: master, method, law

      do master = 1, size(points)
         do method = 1, 2
            do law = 0, 1
               call test('tangent of a point, '//trim(points(master))//', own method '// &
                  & achar(48 + method)//', own law '//achar(48 + law))
               call new_point_scene(scene, trim(points(master)), 1)
               if (method == 1) then
                  call copy_method(spring_type(width=0.05_wp), scene%enforcement%method)
               else
                  call copy_method(compliant_type(share=0.4_wp), scene%enforcement%method)
               end if
               if (law == 1) scene%friction = friction_type(law=law_of%own, mu=0.4_wp, m=0.3_wp, &
                  & own=tanh_radius)
               call one_tangent(scene)
            end do
         end do
      end do
   end subroutine tangents_of_points

   !> Fourth-order differences; a draw near a kink is drawn again.
   subroutine one_tangent(scene)
      type(point_scene_type), intent(inout) :: scene
      real(wp), parameter :: h = 3.0e-5_wp, far(4) = [-2.0_wp, -1.0_wp, 1.0_wp, 2.0_wp], &
         & share(4) = [1.0_wp, -8.0_wp, 8.0_wp, -1.0_wp]/12.0_wp
      real(wp) :: u(scene%dofs%n), x(scene%dofs%n + scene%ndim), lambda(3), shear(3), scale
      real(wp), dimension(scene%dofs%n + scene%ndim, scene%dofs%n + scene%ndim) :: k, difference
      integer :: i, j, n, d, status, try
      logical :: kink

      d = scene%ndim
      n = scene%dofs%n
      do try = 1, 50
         u(:) = random(n, 0.02_wp)
         lambda = 0.0_wp
         call look(scene, u, lambda)
         lambda(:d) = 5.0_wp*scene%state%normal(:d) + random(d, 1.0_wp)
         call look(scene, u, lambda)
         status = scene%state%status
         k = scene%k
         shear = scene%state%traction - dot_product(scene%state%traction, scene%state%normal) &
            & *scene%state%normal
         kink = status == 0 .or. (scene%friction%law /= law_of%none .and. norm2(shear) < 0.1_wp)
         if (kink) cycle
         difference = 0.0_wp
         do i = 1, n + d
            do j = 1, 4
               x(:n) = u
               x(n + 1:) = lambda(:d)
               x(i) = x(i) + far(j)*h
               call look(scene, x(:n), [x(n + 1:), spread(0.0_wp, 1, 3 - d)], .false.)
               kink = kink .or. scene%state%status /= status
               difference(:, i) = difference(:, i) + share(j)/h*scene%residual
            end do
         end do
         if (.not. kink) exit
      end do
      call is_true('there is a smooth draw', .not. kink)
      scale = maxval(abs(difference(:n, :)))
      call close_to('d force', k(:n, :)/scale, difference(:n, :)/scale, 1.0e-8_wp)
      call close_to('d row', k(n + 1:, :), difference(n + 1:, :), 1.0e-8_wp)
   end subroutine one_tangent

   subroutine slopes_of_the_radius()
      type(friction_type) :: law
      type(condition_type) :: at
      real(wp) :: f(2), q, p, slope_q, slope_p, unused(2)
      real(wp), parameter :: h = 1.0e-5_wp
      integer :: i

      call test('slopes of an own law of friction, inside and outside the disc')
      law = friction_type(law=law_of%own, mu=0.3_wp, m=0.5_wp, own=tanh_radius)
      at = condition_type(yield=10.0_wp, growth=1.2_wp)
      do i = 1, 6
         p = 2.0_wp*i
         q = merge(0.2_wp, 8.0_wp, i < 3)
         call return_to_disc(law, q, 50.0_wp, p, at, f(1), slope_q, slope_p)
         call is_true('slips', f(1) < q .eqv. i >= 3)
         call return_to_disc(law, q, 50.0_wp, p + h, at, f(2), unused(1), unused(2))
         call return_to_disc(law, q, 50.0_wp, p - h, at, f(1), unused(1), unused(2))
         call close_to('in the pressure', slope_p, (f(2) - f(1))/(2.0_wp*h), 1.0e-8_wp)
         call return_to_disc(law, q + h, 50.0_wp, p, at, f(2), unused(1), unused(2))
         call return_to_disc(law, q - h, 50.0_wp, p, at, f(1), unused(1), unused(2))
         call close_to('in the trial', slope_q, (f(2) - f(1))/(2.0_wp*h), 1.0e-8_wp)
      end do
   end subroutine slopes_of_the_radius

   subroutine tangent_of_the_surface()
      type(plastic_type) :: self
      type(flow_type) :: flow
      type(plastic_past_type) :: past
      type(plastic_answer_type) :: answer, more, less
      real(wp) :: e(6), way(6), stress(6)
      real(wp), parameter :: h = 1.0e-6_wp
      integer :: i

      call test('consistent tangent of an own yield surface')
      allocate (self%yield, source=quartic_type(bend=1.5_wp))
      self%kinematic%n = 1
      self%kinematic%modulus(1) = 20.0_wp
      past%strain = 0.1_wp
      past%radius = 1.1_wp
      flow = voce_flow(2.0_wp, 1.0_wp, 3.0_wp, 0.4_wp)
      do i = 1, 10
         e = random(6, 0.1_wp)
         way = random(6, 1.0_wp)
         call return_to_surface(self, flow, 80.0_wp, e, past, answer)
         call return_to_surface(self, flow, 80.0_wp, e + h*way, past, more)
         call return_to_surface(self, flow, 80.0_wp, e - h*way, past, less)
         call is_true('flows', answer%found .and. answer%step > 0.0_wp)
         stress = (more%stress - less%stress)/(2.0_wp*h)
         call close_to('d stress', matmul(answer%slope, way)/norm2(stress), stress/norm2(stress), &
            & 1.0e-8_wp)
      end do
   end subroutine tangent_of_the_surface

   !> Two blocks without Poisson's effect, whose meshes do not match, driven onto each other.
   function blocks(nlgeom, plastic, drag) result(text)
      logical, intent(in) :: nlgeom, plastic
      character(len=*), intent(in) :: drag     !! last line of *BOUNDARY of a second step; '': none
      character(len=:), allocatable :: text

      text = box('UP', 0, [0.0_wp, 0.0_wp], [4.0_wp, 2.0_wp], [3, 2], 1.0e30_wp) &
         & //box('LOW', 100000, [0.0_wp, -2.0_wp], [4.0_wp, 0.0_wp], [4, 2], 0.0_wp) &
         & //'*MATERIAL, NAME=A'//nl//'*ELASTIC'//nl//'2000., 0.'//nl
      if (plastic) text = text//'*PLASTIC'//nl//'500., 0.'//nl
      text = text//'*MATERIAL, NAME=B'//nl//'*ELASTIC'//nl//'700., 0.'//nl &
         & //'*SOLID SECTION, ELSET=UP, MATERIAL=A'//nl &
         & //'*SOLID SECTION, ELSET=LOW, MATERIAL=B'//nl &
         & //'*SURFACE INTERACTION, NAME=TOUCH'//nl//'*SURFACE BEHAVIOR, DIRECT'//nl &
         & //'*CONTACT PAIR, INTERACTION=TOUCH, TYPE=SURFACE TO SURFACE'//nl//'UPF, LOWF'//nl &
         & //'*BOUNDARY'//nl//'LOWX0, 1'//nl//'LOWBOT, 2'//nl//'UPTOP, 1'//nl &
         & //'*STEP'//trim(merge(', NLGEOM', '        ', nlgeom))//nl//'*STATIC, DIRECT'//nl &
         & //'0.5, 1.'//nl//'*BOUNDARY'//nl//'UPTOP, 2, 2, -0.1'//nl//'*END STEP'//nl
      if (len(drag) > 0) text = text//'*STEP'//trim(merge(', NLGEOM', '        ', nlgeom))//nl// &
         & '*STATIC, DIRECT'//nl//'0.25, 1.'//nl//'*BOUNDARY'//nl//drag//nl//'*END STEP'//nl
   end function blocks

   subroutine build(text, model)
      character(len=*), intent(in) :: text
      type(model_type), intent(out) :: model
      type(deck_type) :: deck
      type(log_type) :: log
      type(error_type), allocatable :: error

      call read_deck_text(deck, text, 'scene.inp', '', log, error)
      if (.not. allocated(error)) call new_model(model, deck, error)
      call is_true('the deck is read', .not. allocated(error))
   end subroutine build

   subroutine run(model, frame)
      type(model_type), intent(inout) :: model
      type(frame_type), intent(out) :: frame
      type(recorder_holder_type) :: recorders(1)
      type(error_type), allocatable :: error
      type(summary_type) :: summary
      type(log_type) :: log
      type(clock_type) :: clock

      allocate (stress_recorder_type :: recorders(1)%recorder)
      call run_analysis(model, recorders, clock, summary, log, error)
      call is_true('it runs to its end', .not. allocated(error))
      select type (last => recorders(1)%recorder)
      class is (last_recorder_type)
         frame = last%frame
      end select
      call is_true('verdict '//verdict_words(frame%certificate%verdict)//': '// &
         & frame%certificate%reason, frame%certificate%verdict == 0)
   end subroutine run

   subroutine patch_by_methods()
      type(model_type) :: model
      type(frame_type) :: frame
      real(wp) :: p
      integer :: path, method

      do path = 1, 2
         do method = 1, 2
            call test('patch by own method '//achar(48 + method)//', path '//achar(48 + path))
            call build(blocks(path == 2, .false., ''), model)
            model%interaction(1)%slope = 4.0e6_wp
            if (method == 1) then
               call copy_method(spring_type(width=1.0e-8_wp), model%interaction(1)%method)
            else
               call copy_method(compliant_type(share=0.5_wp), model%interaction(1)%method)
            end if
            call run(model, frame)
            associate (c => frame%contact(1))
               p = sum(c%pressure)/size(c%pressure)
               call is_true('all press', p > 10.0_wp)
               call close_to('uniform pressure', c%pressure/p, 0.0_wp*c%pressure + 1.0_wp, &
                  & 1.0e-9_wp)
               if (method == 1) call close_to('its law', c%pressure/p, &
                  & c%gap**2/1.0e-8_wp/p, 1.0e-9_wp)
               if (method == 2) call close_to('its penetration', -c%gap*4.0e6_wp/(0.5_wp*p), &
                  & c%pressure/p, 1.0e-9_wp)
            end associate
         end do
      end do
   end subroutine patch_by_methods

   !> A method that allows a share of the penetration is the perturbed Lagrangian by another slope.
   subroutine a_share_of_the_slope()
      type(model_type) :: model
      type(frame_type) :: own, known
      integer :: path

      do path = 1, 2
         call test('a share of the penetration is a steeper slope, path '//achar(48 + path))
         call build(blocks(path == 2, .false., ''), model)
         model%interaction(1)%slope = 4.0e6_wp
         call copy_method(compliant_type(share=0.25_wp), model%interaction(1)%method)
         call run(model, own)
         model%interaction(1)%slope = 1.6e7_wp
         call new_enforcement(model%interaction(1)%method, 'perturbed')
         call run(model, known)
         call close_to('displacements', own%u, known%u, 1.0e-12_wp)
         call close_to('pressures', own%contact(1)%pressure, known%contact(1)%pressure, 1.0e-9_wp)
         call close_to('stored energy', own%energy%contact, known%energy%contact, 1.0e-9_wp)
      end do
   end subroutine a_share_of_the_slope

   subroutine friction_as_coulomb()
      type(model_type) :: model
      type(frame_type) :: own, known
      integer :: path

      do path = 1, 2
         call test('Coulomb''s law written once more gives its bits, path '//achar(48 + path))
         call build(blocks(path == 2, .false., 'UPTOP, 1, 1, 0.05'), model)
         model%interaction(1)%friction%law = law_of%coulomb
         model%interaction(1)%friction%mu = 0.2_wp
         call run(model, known)
         model%interaction(1)%friction%law = law_of%own
         model%interaction(1)%friction%own => coulomb_radius
         call run(model, own)
         call is_true('something slips', any(own%contact(1)%status == 2))
         call is_true('displacements', all(abs(own%u - known%u) <= 1.0e-13_wp))
         call close_to('forces', own%contact(1)%force, known%contact(1)%force, 1.0e-10_wp)
      end do
   end subroutine friction_as_coulomb

   subroutine friction_of_its_own()
      type(model_type) :: model
      type(frame_type) :: frame
      real(wp) :: press, k, radius, tangent(2)
      integer :: i, path

      do path = 1, 2
         call test('an own law of friction bounds the shear, path '//achar(48 + path))
         call build(blocks(path == 2, .true., 'UPTOP, 1, 1, 0.3'), model)
         model%interaction(1)%friction = friction_type(law=law_of%own, mu=0.3_wp, m=0.05_wp, &
            & own=tanh_radius)
         call run(model, frame)
         k = 0.05_wp*500.0_wp/sqrt(3.0_wp)
         associate (c => frame%contact(1))
            call is_true('all slip', all(c%status == 2 .or. .not. abs(c%pressure) > 0.0_wp))
            do i = 1, size(c%node)
               press = dot_product(c%force(:2, i), c%normal(:2, i))
               tangent = c%force(:2, i) - press*c%normal(:2, i)
               radius = c%weight(i)*k*tanh(0.3_wp*press/c%weight(i)/k)
               if (path == 1) call close_to('shear', norm2(tangent)/radius, 1.0_wp, 1.0e-9_wp)
               if (path == 2) call close_to('shear', norm2(tangent)/radius, 1.0_wp, 2.0e-2_wp)
            end do
         end associate
      end do
   end subroutine friction_of_its_own

   !> A block of eight bricks that is pulled, its bottom held in all directions or free to contract.
   function pulled(held, far) result(text)
      logical, intent(in) :: held
      character(len=*), intent(in) :: far
      character(len=:), allocatable :: text

      text = box('UP', 0, [0.0_wp, 0.0_wp, 0.0_wp], [1.0_wp, 1.0_wp, 1.0_wp], [2, 2, 2], 0.0_wp) &
         & //'*MATERIAL, NAME=A'//nl//'*ELASTIC'//nl//'2000., 0.3'//nl//'*PLASTIC'//nl &
         & //'10., 0.'//nl//'*SOLID SECTION, ELSET=UP, MATERIAL=A'//nl//'*BOUNDARY'//nl &
         & //'UPX0, 1'//nl//'UPY0, 2'//nl//'UPBOT, 3'//nl
      if (held) text = text//'UPBOT, 1, 2'//nl
      text = text//'*STEP'//nl//'*STATIC, DIRECT'//nl//'0.5, 1.'//nl//'*BOUNDARY'//nl &
         & //'UPTOP, 3, 3, '//far//nl//'*END STEP'//nl
   end function pulled

   subroutine surface_as_von_mises()
      type(model_type) :: model
      type(frame_type) :: own, known

      call test('the own surface that nothing bends is von Mises''')
      call build(pulled(.true., '0.02'), model)
      call run(model, known)
      allocate (model%material(1)%plastic)
      allocate (model%material(1)%plastic%yield, source=quartic_type(bend=0.0_wp))
      call run(model, own)
      call is_true('it flows', maxval(known%plastic_strain) > 0.01_wp)
      call close_to('displacements', own%u, known%u, 1.0e-9_wp)
      call close_to('stresses', own%stress, known%stress, 1.0e-6_wp)
   end subroutine surface_as_von_mises

   !> In tension phi = (1 + 18/81 bend)^(1/4) times the stress.
   subroutine surface_of_its_own()
      type(model_type) :: model
      type(frame_type) :: frame
      real(wp), parameter :: bend = 1.5_wp
      integer :: i

      call test('patch in tension by an own yield surface')
      call build(pulled(.false., '0.02'), model)
      allocate (model%material(1)%plastic)
      allocate (model%material(1)%plastic%yield, source=quartic_type(bend=bend))
      call run(model, frame)
      do i = 1, size(frame%stress, 2)
         call close_to('stress', frame%stress(:, i), [0.0_wp, 0.0_wp, &
            & 10.0_wp/(1.0_wp + 18.0_wp/81.0_wp*bend)**0.25_wp, 0.0_wp, 0.0_wp, 0.0_wp], 1.0e-8_wp)
      end do
   end subroutine surface_of_its_own
end program test_own_laws
