!> Pieces of a scene as VTK cells: the solid, the slave surface of a pair, a tool.
module lopin_vtu_parts
   use, intrinsic :: iso_fortran_env, only : int8, int32
   use, intrinsic :: ieee_arithmetic, only : ieee_value, ieee_quiet_nan
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_type, new_cell_of
   use lopin_element_type, only : cells_of_words
   use lopin_rigid_motion, only : rigid_motion_type, new_rigid_motion
   use lopin_model, only : model_type, surface_of
   use lopin_report, only : frame_type, damage_field_type, contact_field_type
   use lopin_vtu_writer, only : vtu_writer_type, vtu_cells_type, three_components
   use lopin_von_mises, only : von_mises
   implicit none
   private
   public :: surface_part_type, new_solid_cells, new_surface_part, write_solid, write_surface, &
      & write_tool, mises

   !> The slave surface of a pair: its nodes, and facets (or vertices) between them.
   type :: surface_part_type
      integer, allocatable :: node(:)        !! mesh node of each point
      integer, allocatable :: point_of(:)    !! (nnode) point of a mesh node; 0: none
      type(vtu_cells_type) :: cells
   end type surface_part_type

   integer, parameter :: vtk_vertex = 1

contains

   !> All elements of the mesh, rigid ones too.
   subroutine new_solid_cells(self, model)
      type(vtu_cells_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(cell_type), allocatable :: cell(:)
      integer :: e, n, filled

      call cells_of_words(model%element_word, cell)
      n = 0
      do e = 1, model%mesh%nelement
         n = n + cell(model%mesh%etype(e))%nnode
      end do
      allocate (self%connectivity(n), self%offsets(model%mesh%nelement), &
         & self%types(model%mesh%nelement))
      filled = 0
      do e = 1, model%mesh%nelement
         associate (c => cell(model%mesh%etype(e)))
            self%connectivity(filled + 1:filled + c%nnode) = &
               & int(model%mesh%conn(c%vtk_order(:c%nnode), e) - 1, int32)
            filled = filled + c%nnode
            self%types(e) = int(c%vtk, int8)
         end associate
         self%offsets(e) = int(filled, int32)
      end do
   end subroutine new_solid_cells

   subroutine new_surface_part(self, model, surface)
      type(surface_part_type), intent(out) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: surface
      integer :: i

      allocate (self%point_of(model%mesh%nnode), source=0)
      allocate (self%node(0))
      if (model%surface(surface)%kind == surface_of%nodes) then
         self%node = model%surface(surface)%node
         self%point_of(self%node) = [(i, i=1, size(self%node))]
         self%cells%connectivity = [(int(i - 1, int32), i=1, size(self%node))]
         self%cells%offsets = [(int(i, int32), i=1, size(self%node))]
         allocate (self%cells%types(size(self%node)))
         self%cells%types = int(vtk_vertex, int8)
      else if (model%surface(surface)%kind == surface_of%faces) then
         call add_facets(self, model, surface)
      else
         allocate (self%cells%connectivity(0), self%cells%offsets(0), self%cells%types(0))
      end if
   end subroutine new_surface_part

   subroutine add_facets(self, model, surface)
      type(surface_part_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: surface
      type(cell_type), allocatable :: cell(:)
      type(cell_type) :: facet
      integer, allocatable :: connectivity(:), node(:)
      integer :: i, k, n, npoint, filled, nface

      call cells_of_words(model%element_word, cell)
      associate (list => model%surface(surface))
         nface = size(list%element)
         allocate (connectivity(8*nface), node(8*nface), self%cells%offsets(nface), &
            & self%cells%types(nface))
         npoint = 0
         filled = 0
         do i = 1, nface
            associate (c => cell(model%mesh%etype(list%element(i))))
               n = c%face_nnode(list%face(i))
               call new_cell_of(facet, c%face_cell(list%face(i)))
               do k = 1, n
                  call add_point(model%mesh%conn(c%face_node(k, list%face(i)), list%element(i)))
               end do
            end associate
            self%cells%types(i) = int(facet%vtk, int8)
            self%cells%offsets(i) = int(filled, int32)
         end do
      end associate
      self%cells%connectivity = int(connectivity(:filled), int32)
      self%node = node(:npoint)
   contains
      subroutine add_point(mesh_node)
         integer, intent(in) :: mesh_node

         if (self%point_of(mesh_node) == 0) then
            npoint = npoint + 1
            node(npoint) = mesh_node
            self%point_of(mesh_node) = npoint
         end if
         filled = filled + 1
         connectivity(filled) = self%point_of(mesh_node) - 1
      end subroutine add_point
   end subroutine add_facets

   !> Displacement, reaction and stress on the mesh as it was at time zero.
   subroutine write_solid(writer, model, cells, frame, with_u, with_rf)
      type(vtu_writer_type), intent(inout) :: writer
      type(model_type), intent(in) :: model
      type(vtu_cells_type), intent(in) :: cells
      type(frame_type), intent(in) :: frame
      logical, intent(in) :: with_u, with_rf

      call writer%start(model%mesh%nnode, model%mesh%nelement, frame%total_time)
      call writer%section('PointData')
      if (with_u) call writer%reals('U', frame%u(:3, :))
      if (with_rf) call writer%reals('RF', frame%rf(:3, :))
      if (allocated(frame%nodal_stress)) then
         call writer%reals('S', frame%nodal_stress([1, 2, 3, 4, 6, 5], :))
         call writer%reals('Mises', mises(frame%nodal_stress))
      end if
      if (allocated(frame%nodal_plastic)) call writer%reals('PEEQ', frame%nodal_plastic)
      if (allocated(frame%damage)) call write_damage(writer, frame%damage)
      call writer%integers('LABEL', model%mesh%node_label)
      call writer%end_section()
      call writer%section('CellData')
      call writer%integers('LABEL', model%mesh%element_label)
      call writer%end_section()
      call writer%points(model%mesh%x)
      call writer%cells(cells)
   end subroutine write_solid

   !> Damage by criterion, and its mean where there is one.
   subroutine write_damage(writer, damage)
      type(vtu_writer_type), intent(inout) :: writer
      type(damage_field_type), intent(in) :: damage(:)
      integer :: k

      do k = 1, size(damage)
         if (.not. allocated(damage(k)%nodal)) cycle
         call writer%reals('DAMAGE_'//damage(k)%name, damage(k)%nodal(:1, :))
         if (damage(k)%averaged) call writer%reals('DAMAGE_'//damage(k)%name//'_MEAN', &
            & damage(k)%nodal(2:, :))
      end do
   end subroutine write_damage

   !> Contact results on the slave surface. A node that has no master opposite has no gap: nan.
   subroutine write_surface(writer, model, part, frame, field)
      type(vtu_writer_type), intent(inout) :: writer
      type(model_type), intent(in) :: model
      type(surface_part_type), intent(in) :: part
      type(frame_type), intent(in) :: frame
      type(contact_field_type), intent(in) :: field
      real(wp), allocatable :: scalar(:, :), vector(:, :, :), xi(:, :)
      integer, allocatable :: status(:)
      integer :: n

      n = size(part%node)
      allocate (scalar(6, n), vector(3, n, 4), xi(2, n), status(n))
      call scatter(part, field, scalar, vector, xi, status)
      call writer%start(n, size(part%cells%types), frame%total_time)
      call writer%section('PointData')
      call writer%reals('CPRESS', scalar(1:1, :))
      call writer%reals('COPEN', scalar(2:2, :))
      call writer%integers('CSTATUS', status)
      call writer%reals('FORCE', vector(:, :, 1))
      call writer%reals('R_n', vector(:, :, 4))
      call writer%reals('R_t', vector(:, :, 1) - vector(:, :, 4))
      call writer%reals('SLIP_PATH', scalar(5:5, :))
      call writer%reals('FRICTION_WORK', scalar(6:6, :))
      call writer%reals('u_n', scalar(3:3, :))
      call writer%reals('u_t', vector(:, :, 2))
      call writer%reals('NORMAL', vector(:, :, 3))
      call writer%reals('XI', xi)
      call writer%reals('WEIGHT', scalar(4:4, :))
      call writer%reals('U', frame%u(:3, part%node))
      call writer%integers('LABEL', model%mesh%node_label(part%node))
      call writer%end_section()
      call writer%points(model%mesh%x(:, part%node))
      call writer%cells(part%cells)
   end subroutine write_surface

   !> A tool near the mesh, where its reference node has carried it.
   subroutine write_tool(writer, model, tool, frame)
      type(vtu_writer_type), intent(inout) :: writer
      type(model_type), intent(in) :: model
      integer, intent(in) :: tool
      type(frame_type), intent(in) :: frame
      type(rigid_motion_type) :: motion
      type(vtu_cells_type) :: list
      real(wp), allocatable :: x(:, :), y(:, :)
      integer, allocatable :: cells(:, :)
      integer :: i

      call model%tool(tool)%shape%tessellate(box_of(model), y, cells)
      call motion_of(model, model%tool(tool)%rigid_body, frame, motion)
      allocate (x(size(y, 1), size(y, 2)))
      do i = 1, size(y, 2)
         x(:, i) = motion%to_global(y(:, i))
      end do
      call tool_cells(cells, list)
      call writer%start(size(x, 2), size(list%types), frame%total_time)
      call writer%section('PointData')
      call writer%reals('MOTION', three_components(x - y))
      call writer%end_section()
      call writer%points(x)
      call writer%cells(list)
   end subroutine write_tool

   subroutine tool_cells(cells, list)
      integer, intent(in) :: cells(:, :)             !! (2 or 4, ncell); triangle: last is 0
      type(vtu_cells_type), intent(out) :: list
      integer :: i, n, last
      integer, parameter :: type_of(2:4) = [3, 5, 9]

      allocate (list%connectivity(count(cells > 0)), list%offsets(size(cells, 2)), &
         & list%types(size(cells, 2)))
      last = 0
      do i = 1, size(cells, 2)
         n = count(cells(:, i) > 0)
         list%connectivity(last + 1:last + n) = int(cells(:n, i) - 1, int32)
         last = last + n
         list%offsets(i) = int(last, int32)
         list%types(i) = int(type_of(n), int8)
      end do
   end subroutine tool_cells

   subroutine motion_of(model, rigid_body, frame, motion)
      type(model_type), intent(in) :: model
      integer, intent(in) :: rigid_body                !! 0: fixed in space
      type(frame_type), intent(in) :: frame
      type(rigid_motion_type), intent(out) :: motion
      real(wp) :: rotation(3)
      integer :: n

      n = model%mesh%ndim
      motion%ndim = n
      if (rigid_body == 0) return
      associate (body => model%rigid_body(rigid_body))
         rotation = frame%u(4:6, body%reference)
         if (body%rotation > 0) rotation = frame%u(1:3, body%rotation)
         call new_rigid_motion(motion, model%mesh%x(:, body%reference), &
            & frame%u(:n, body%reference), rotation(merge(3, 1, n == 2):3))
      end associate
   end subroutine motion_of

   !> The mesh and a quarter of its size around it; reference nodes may stand far away and do not
   !> count.
   pure function box_of(model) result(box)
      type(model_type), intent(in) :: model
      real(wp) :: box(model%mesh%ndim, 2)
      real(wp) :: margin
      integer :: e, k

      box(:, 1) = huge(1.0_wp)
      box(:, 2) = -huge(1.0_wp)
      do e = 1, model%mesh%nelement
         do k = 1, size(model%mesh%conn, 1)
            if (model%mesh%conn(k, e) == 0) exit
            box(:, 1) = min(box(:, 1), model%mesh%x(:, model%mesh%conn(k, e)))
            box(:, 2) = max(box(:, 2), model%mesh%x(:, model%mesh%conn(k, e)))
         end do
      end do
      margin = 0.25_wp*maxval(box(:, 2) - box(:, 1))
      box(:, 1) = box(:, 1) - margin
      box(:, 2) = box(:, 2) + margin
   end function box_of

   !> From slave points to nodes of the part; a node may have two points, near a concave corner of
   !> a tool.
   subroutine scatter(part, field, scalar, vector, xi, status)
      type(surface_part_type), intent(in) :: part
      type(contact_field_type), intent(in) :: field
      real(wp), intent(out) :: scalar(:, :)      !! (6, n) pressure, gap, u_n, weight, path, work
      real(wp), intent(out) :: vector(:, :, :)   !! (3, n, 4) force, u_t, normal, normal force
      real(wp), intent(out) :: xi(:, :)          !! (2, n)
      integer, intent(out) :: status(:)
      integer :: i, k, d

      scalar = 0.0_wp
      scalar(2, :) = ieee_value(0.0_wp, ieee_quiet_nan)
      vector = 0.0_wp
      xi = 0.0_wp
      status = -1
      d = size(field%normal, 1)
      do i = 1, size(field%node)
         k = part%point_of(field%node(i))
         if (k == 0) cycle
         vector(:d, k, 1) = vector(:d, k, 1) + field%force(:, i)
         vector(:d, k, 4) = vector(:d, k, 4) + field%force(:, i) - field%shear(:, i)
         if (allocated(field%friction_work)) scalar(6, k) = scalar(6, k) + field%friction_work(i)
         if (field%status(i) < 0) cycle
         if (status(k) >= 0) then
            if (field%gap(i) > scalar(2, k)) cycle
         end if
         if (allocated(field%slip_path)) scalar(5, k) = field%slip_path(i)
         scalar(:4, k) = [field%pressure(i), field%gap(i), field%u_n(i), field%weight(i)]
         vector(:d, k, 2) = field%u_t(:, i)
         vector(:d, k, 3) = field%normal(:, i)
         xi(:, k) = field%xi(:, i)
         status(k) = max(status(k), field%status(i))
      end do
   end subroutine scatter

   pure function mises(s) result(q)
      real(wp), intent(in) :: s(:, :)      !! (6, n) xx yy zz and three shears
      real(wp), allocatable :: q(:, :)     !! (1, n)
      integer :: i

      allocate (q(1, size(s, 2)))
      do i = 1, size(s, 2)
         q(1, i) = von_mises(s(:, i))
      end do
   end function mises
end module lopin_vtu_parts
