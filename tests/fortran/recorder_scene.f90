!> A scene without a solver: two elements of one word, a pair of surfaces, a tool, made-up results.
module recorder_scene
   use, intrinsic :: ieee_arithmetic, only : ieee_value, ieee_quiet_nan
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, severity, location_type
   use lopin_tool_factory, only : new_tool_sphere
   use lopin_enforcement_factory, only : new_enforcement
   use lopin_element_type, only : element_type, new_element_type
   use lopin_model, only : model_type, output_type, surface_of, kind_of
   use lopin_report, only : frame_type, summary_type, contact_field_type
   implicit none
   private
   public :: make_scene, make_frame, make_summary, make_bricks, add_output

contains

   !> The second element is the first, moved up; both have their own nodes; the last node is the
   !> tool's.
   subroutine make_scene(model, word)
      type(model_type), intent(out) :: model
      character(len=*), intent(in) :: word
      type(element_type) :: element
      logical :: found
      integer :: n, k, d

      call new_element_type(element, word, '', found)
      n = element%nnode
      d = element%ndim
      associate (mesh => model%mesh)
         mesh%ndim = d
         mesh%nnode = 2*n + 1
         mesh%nelement = 2
         allocate (mesh%x(d, 2*n + 1), source=9.0_wp)
         mesh%x(:, :n) = element%cell%xi(:d, :n)
         mesh%x(1, :n) = mesh%x(1, :n) + 3.0_wp
         mesh%x(:, n + 1:2*n) = mesh%x(:, :n)
         mesh%x(d, n + 1:2*n) = mesh%x(d, :n) + 2.0_wp
         mesh%node_label = [(10*k, k=1, 2*n + 1)]
         allocate (mesh%conn(20, 2), source=0)
         mesh%conn(:n, 1) = [(k, k=1, n)]
         mesh%conn(:n, 2) = [(n + k, k=1, n)]
         mesh%etype = [1, 1]
         mesh%section = [1, 1]
         mesh%element_label = [7, 3]
         allocate (mesh%nset(2), mesh%elset(1))
         mesh%nset(1)%name = 'SOME'
         mesh%nset(1)%member = [3, 1, 2]
         mesh%nset(2)%name = 'LOW'
         mesh%nset(2)%member = [(k, k=1, n)]
         mesh%elset(1)%name = 'BOTH'
         mesh%elset(1)%member = [1, 2]
      end associate
      model%kind = merge(kind_of%solid, kind_of%plane_strain, d == 3)
      if (word(1:3) == 'CAX') model%kind = kind_of%axisymmetric
      call fill_model(model, word, n)
   end subroutine make_scene

   subroutine fill_model(model, word, n)
      type(model_type), intent(inout) :: model
      character(len=*), intent(in) :: word
      integer, intent(in) :: n          !! nodes of an element
      type(error_type), allocatable :: error
      real(wp) :: centre(model%mesh%ndim)
      integer :: k

      model%heading = 'Two elements, "quoted" \ slashed'
      model%element_word = [character(len=8) :: word]
      allocate (model%material(1), model%section(1), model%surface(4), model%tool(1), &
         & model%rigid_body(1))
      allocate (model%interaction(1), model%pair(2), model%amplitude(0), model%equation(0), &
         & model%spring(0), &
         & model%step(1))
      model%material(1)%name = 'STEEL'
      model%section(1)%material = 1
      model%section(1)%thickness = 2.0_wp
      model%surface(1)%name = 'TOP'
      model%surface(1)%element = [2, 2]
      model%surface(1)%face = [1, 2]
      model%surface(2)%name = 'DIE'
      model%surface(2)%element = [1]
      model%surface(2)%face = [2]
      model%surface(3)%name = 'DOTS'
      model%surface(3)%kind = surface_of%nodes
      model%surface(3)%node = [(n + k, k=1, 3)]
      model%surface(4)%name = 'SKIN OF/BALL'
      model%surface(4)%kind = surface_of%tool
      model%surface(4)%tool = 1
      model%tool(1)%name = 'BALL'
      model%tool(1)%rigid_body = 1
      centre = 0.0_wp
      centre(size(centre)) = 5.0_wp
      call new_tool_sphere(model%tool(1)%shape, centre, 2.0_wp, .false., error)
      model%rigid_body(1)%name = 'BALL'
      model%rigid_body(1)%reference = model%mesh%nnode
      model%rigid_body(1)%tool = 1
      model%interaction(1)%name = 'GREASE'
      call new_enforcement(model%interaction(1)%method, 'lagrange')
      model%pair(1)%slave = 1
      model%pair(1)%master = 2
      model%pair(1)%interaction = 1
      model%pair(2)%slave = 3
      model%pair(2)%master = 4
      model%pair(2)%interaction = 1
      allocate (model%step(1)%output(0))
      call model%log%say(severity%warning, 'W0311', 'made up'//achar(9)//'for "tests"', &
         & location_type(1, 12, 3, 5), help='nothing')
   end subroutine fill_model

   subroutine add_output(model, kind, words, set, totals, totals_only, frequency)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: kind
      character(len=*), intent(in) :: words(:)
      integer, intent(in), optional :: set, frequency
      logical, intent(in), optional :: totals, totals_only
      type(output_type) :: one
      type(output_type), allocatable :: longer(:)
      integer :: n

      one%kind = kind
      allocate (one%variable(size(words)))
      one%variable = words
      if (present(set)) one%set = set
      if (present(totals)) one%totals = totals
      if (present(totals_only)) one%totals_only = totals_only
      if (present(frequency)) one%frequency = frequency
      n = size(model%step(1)%output)
      allocate (longer(n + 1))
      longer(:n) = model%step(1)%output
      longer(n + 1) = one
      call move_alloc(longer, model%step(1)%output)
   end subroutine add_output

   !> u = increment*1e-3*(x, y, z), stress and strain by integration point number, pressure by node.
   subroutine make_frame(frame, model, increment, last)
      type(frame_type), intent(out) :: frame
      type(model_type), intent(in) :: model
      integer, intent(in) :: increment, last
      type(element_type) :: element
      logical :: found
      integer :: i, k, n, d

      d = model%mesh%ndim
      n = model%mesh%nnode
      call new_element_type(element, trim(model%element_word(1)), '', found)
      frame%step = 1
      frame%increment = increment
      frame%iterations = 3
      frame%time_increment = 1.0_wp/real(last, wp)
      frame%total_time = real(increment, wp)/real(last, wp)
      frame%step_time = frame%total_time
      frame%last_of_step = increment == last
      allocate (frame%u(6, n), frame%rf(6, n), source=0.0_wp)
      frame%u(:d, :) = 1.0e-3_wp*real(increment, wp)*model%mesh%x
      frame%rf(d, :) = [(real(i, wp), i=1, n)]
      frame%u(:, n) = 0.0_wp
      frame%u(d, n) = -0.25_wp
      frame%first_point = [(1 + (i - 1)*element%ngauss, i=1, model%mesh%nelement + 1)]
      k = frame%first_point(model%mesh%nelement + 1) - 1
      allocate (frame%stress(6, k), frame%strain(6, k), frame%nodal_stress(6, n))
      do i = 1, k
         frame%stress(:, i) = 100.0_wp*i + [1, 2, 3, 4, 5, 6]
         frame%strain(:, i) = 1.0e-3_wp*[1, 2, 3, 4, 6, 8]
      end do
      do i = 1, n
         frame%nodal_stress(:, i) = real(i, wp)*[1, 2, 3, 4, 5, 6]
      end do
      allocate (frame%contact(size(model%pair)))
      do i = 1, size(model%pair)
         call make_contact(frame%contact(i), model, model%pair(i)%slave)
      end do
      frame%closed = 2
      frame%augmentations = 1
      frame%energy%strain = 0.5_wp
      frame%certificate%reason = ''
   end subroutine make_frame

   !> The nodes of the second element that come first; the last of them has no master opposite.
   subroutine make_contact(field, model, surface)
      type(contact_field_type), intent(out) :: field
      type(model_type), intent(in) :: model
      integer, intent(in) :: surface
      integer :: d, n, k, first

      d = model%mesh%ndim
      n = merge(3, d, model%surface(surface)%kind == surface_of%nodes)
      first = model%mesh%conn(1, 2)
      field%node = [(first + k - 1, k=1, n)]
      field%facet = [(1, k=1, n)]
      field%status = [(1, k=1, n)]
      field%status(n) = -1
      allocate (field%weight(n), source=2.0_wp)
      allocate (field%gap(n), field%pressure(n), field%u_n(n), source=0.0_wp)
      field%gap = [(-0.01_wp*k, k=1, n)]
      field%pressure = [(10.0_wp*k, k=1, n)]
      field%gap(n) = huge(1.0_wp)
      field%pressure(n) = 0.0_wp
      allocate (field%normal(d, n), field%force(d, n), field%u_t(d, n), source=0.0_wp)
      field%normal(d, :) = 1.0_wp
      field%force(d, :) = field%weight*field%pressure
      allocate (field%shear(d, n), field%couple(3, n), source=0.0_wp)
      field%u_t(1, :) = 0.5_wp
      allocate (field%xi(2, n), source=0.25_wp)
   end subroutine make_contact

   subroutine make_summary(summary)
      type(summary_type), intent(out) :: summary
      summary%status = 'finished'
      summary%plan = 'nothing was solved'
      summary%path = 'condensed'
      summary%solver = 'none'
      summary%equations = 12
      allocate (summary%step(1))
      summary%step(1)%increments = 2
      summary%clock%seconds(1) = 0.5_wp
      summary%peak_memory = ieee_value(0.0_wp, ieee_quiet_nan)
   end subroutine make_summary

   !> n x n x n bricks without contact, for timing.
   subroutine make_bricks(model, n)
      type(model_type), intent(out) :: model
      integer, intent(in) :: n
      integer :: i, j, k, e, node

      associate (mesh => model%mesh)
         mesh%ndim = 3
         mesh%nnode = (n + 1)**3
         mesh%nelement = n**3
         allocate (mesh%x(3, mesh%nnode), mesh%conn(20, mesh%nelement))
         mesh%conn = 0
         node = 0
         do k = 0, n
            do j = 0, n
               do i = 0, n
                  node = node + 1
                  mesh%x(:, node) = real([i, j, k], wp)
                  if (max(i, j, k) == n) cycle
                  e = 1 + i + n*(j + n*k)
                  mesh%conn(:8, e) = node + [0, 1, n + 2, n + 1, (n + 1)**2, (n + 1)**2 + 1, &
                     & (n + 1)**2 + n + 2, (n + 1)**2 + n + 1]
               end do
            end do
         end do
         mesh%node_label = [(i, i=1, mesh%nnode)]
         mesh%element_label = [(i, i=1, mesh%nelement)]
         allocate (mesh%etype(mesh%nelement), mesh%section(mesh%nelement))
         mesh%etype = 1
         mesh%section = 1
         allocate (mesh%nset(0), mesh%elset(0))
      end associate
      model%heading = ''
      model%kind = kind_of%solid
      model%element_word = [character(len=8) :: 'C3D8']
      allocate (model%material(1), model%section(1), model%surface(0), model%tool(0), &
         & model%rigid_body(0))
      allocate (model%interaction(0), model%pair(0), model%amplitude(0), model%equation(0), &
         & model%spring(0), &
         & model%step(1))
      model%material(1)%name = 'STEEL'
      model%section(1)%material = 1
      allocate (model%step(1)%output(0))
   end subroutine make_bricks
end module recorder_scene
